// SPDX-License-Identifier: MIT
#include "earshot/io/internal/acoustics_extras.h"

#include "earshot/base/spelling.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <vector>

namespace earshot::io {
namespace {

using Json = nlohmann::json;
using propagation::EnergyCoefficient;
using propagation::Material;

/// Who an error is about: the file, and in it "material wall".
struct Place {
    const std::string& file;
    std::string element;

    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Error(file, element + ": " + what, remedy);
    }
};

/// extras.acoustics, if the object has it.
const Json* acoustics_of(const Json& object, const Place& place) {
    const auto extras = object.find("extras");
    if (extras == object.end() || !extras->is_object() || !extras->contains("acoustics")) {
        return nullptr;
    }
    const Json& acoustics = (*extras)["acoustics"];
    if (!acoustics.is_object()) {
        place.fail("extras.acoustics is not a JSON object", "write {\"absorption\": 0.1}");
    }
    return &acoustics;
}

template <std::size_t Count>
void warn_of_unknown_keys(const Json& acoustics,
                          const std::array<std::string_view, Count>& known,
                          const Place& place,
                          Warnings& warnings) {
    for (const auto& [key, value] : acoustics.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            warnings.push_back({place.file,
                                place.element + ": extras.acoustics has a key \"" + key +
                                    "\" that means nothing here"});
        }
    }
}

double energy_value(const Json& number, const std::string& key, const Place& place) {
    if (!number.is_number()) {
        place.fail(key + " is not a number", "give a number from 0 to 1");
    }
    const auto value = number.get<double>();
    if (!(value >= 0.0 && value <= 1.0)) {
        place.fail(key + " is " + number.dump() + ", not in 0..1", "give a number from 0 to 1");
    }
    return value;
}

double frequency_of(const std::string& key, const std::string& coefficient, const Place& place) {
    double frequency = 0.0;
    const auto [end, code] = std::from_chars(key.data(), key.data() + key.size(), frequency);
    const bool is_number = code == std::errc() && end == key.data() + key.size();
    if (!is_number || !(frequency > 0.0 && frequency < 1e9)) {
        place.fail(coefficient + " has a band \"" + key + "\" that is not a frequency",
                   "write the band centre in hertz, as in {\"125\": 0.1}");
    }
    return frequency;
}

std::optional<EnergyCoefficient> read_coefficient(const Json& acoustics,
                                                  const char* key,
                                                  const Place& place) {
    const auto found = acoustics.find(key);
    if (found == acoustics.end()) {
        return std::nullopt;
    }
    if (!found->is_object()) {
        return EnergyCoefficient(energy_value(*found, key, place));
    }
    std::vector<EnergyCoefficient::Point> points;
    for (const auto& [band, value] : found->items()) {
        const std::string label = std::string(key) + " at " + band + " Hz";
        points.push_back({frequency_of(band, key, place), energy_value(value, label, place)});
    }
    try {
        return EnergyCoefficient(std::move(points));
    } catch (const Error& error) {
        place.fail(std::string(key) + ": " + error.what(), error.remedy());
    }
}

Material library_material(const Json& name, const Place& place) {
    if (!name.is_string()) {
        place.fail("library is not a name", "see earshot materials");
    }
    std::optional<Material> found =
        propagation::find_library_material(name.get_ref<const std::string&>());
    if (!found) {
        place.fail("the library has no material \"" + name.get<std::string>() + "\"",
                   nearest_library_names(name.get<std::string>()));
    }
    return std::move(*found);
}

}  // namespace

std::string nearest_library_names(const std::string& name) {
    constexpr std::size_t kSuggestions = 3;
    std::vector<std::string> names;
    for (const propagation::LibraryMaterial& row : propagation::material_library()) {
        names.emplace_back(row.name);
    }
    std::string text;
    for (const std::string& close : closest_words(name, names, kSuggestions)) {
        text += (text.empty() ? "nearest are " : ", ") + close;
    }
    return text.empty() ? "see earshot materials" : text + " (see earshot materials)";
}

Material material_named(const std::string& name, const std::string& file, Warnings& warnings) {
    if (std::optional<Material> found = propagation::find_library_material(name)) {
        found->name = name;
        return std::move(*found);
    }
    warnings.push_back(
        {file, "material \"" + name + "\" has no acoustic data and takes absorption 0.1"});
    Material material;
    material.name = name;
    return material;
}

Material read_material(const Json& json,
                       const std::string& name,
                       const std::string& file,
                       Warnings& warnings) {
    const Place place{file, "material \"" + name + "\""};
    const Json* acoustics = acoustics_of(json, place);
    if (acoustics == nullptr) {
        return material_named(name, file, warnings);
    }
    constexpr std::array<std::string_view, 5> kKnown{
        "absorption", "scattering", "transmission", "library", "one_sided"};
    warn_of_unknown_keys(*acoustics, kKnown, place, warnings);
    Material material;
    if (acoustics->contains("library")) {
        material = library_material((*acoustics)["library"], place);
    }
    material.name = name;
    if (auto given = read_coefficient(*acoustics, "absorption", place)) {
        material.absorption = std::move(*given);
    }
    if (auto given = read_coefficient(*acoustics, "scattering", place)) {
        material.scattering = std::move(*given);
    }
    if (auto given = read_coefficient(*acoustics, "transmission", place)) {
        material.transmission = std::move(*given);
    }
    if (acoustics->contains("one_sided")) {
        const Json& one_sided = (*acoustics)["one_sided"];
        if (!one_sided.is_boolean()) {
            place.fail("one_sided is neither true nor false", "write true or false");
        }
        material.one_sided = one_sided.get<bool>();
    }
    try {
        propagation::validate(material);
    } catch (const Error& error) {
        place.fail(error.what(), error.remedy());
    }
    return material;
}

NodeAcoustics read_node_acoustics(const Json& node,
                                  const std::string& name,
                                  const std::string& file,
                                  Warnings& warnings) {
    const Place place{file, "node \"" + name + "\""};
    const Json* acoustics = acoustics_of(node, place);
    if (acoustics == nullptr) {
        return {};
    }
    constexpr std::array<std::string_view, 2> kKnown{"role", "directivity"};
    warn_of_unknown_keys(*acoustics, kKnown, place, warnings);
    NodeAcoustics read;
    if (acoustics->contains("role")) {
        const Json& role = (*acoustics)["role"];
        if (role == "source") {
            read.role = Role::source;
        } else if (role == "listener") {
            read.role = Role::listener;
        } else {
            place.fail("its role is " + role.dump(), "write \"source\" or \"listener\"");
        }
    }
    if (acoustics->contains("directivity")) {
        const Json& directivity = (*acoustics)["directivity"];
        if (!directivity.is_string()) {
            place.fail("its directivity is not a name", "name a pattern");
        }
        read.directivity = directivity.get<std::string>();
    }
    return read;
}

}  // namespace earshot::io
