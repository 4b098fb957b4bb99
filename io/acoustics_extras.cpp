// SPDX-License-Identifier: MIT
#include "earshot/io/internal/acoustics_extras.h"

#include "earshot/base/spelling.h"
#include "earshot/io/internal/json_depth.h"

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

/// What is written in a string: a JSON object, or else the string itself.
Json unpacked(const Json& value, const Place& place, const std::string& key) {
    if (!value.is_string()) {
        return value;
    }
    const std::string& text = value.get_ref<const std::string&>();
    if (text.find('{') == std::string::npos) {
        return value;
    }
    if (exceeds_json_depth(text)) {
        place.fail(key + " is nested more than " + std::to_string(kMaxJsonDepth) + " levels deep",
                   R"(write a library name, or as in {"absorption": 0.1})");
    }
    Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) {
        place.fail(key + " is a text that is no JSON object",
                   R"(write a library name, or as in {"absorption": 0.1})");
    }
    return json;
}

constexpr std::string_view kFlatPrefix = "acoustics_";

/// acoustics_absorption and its like, as the property panels of modellers write them.
Json flat_acoustics(const Json& extras, const Place& place) {
    Json acoustics = Json::object();
    for (const auto& [key, value] : extras.items()) {
        if (key.starts_with(kFlatPrefix)) {
            acoustics[key.substr(kFlatPrefix.size())] = unpacked(value, place, key);
        }
    }
    return acoustics;
}

/// Keys of extras that were probably meant for us: "acoustic", "Acoustics", a plain "absorption".
template <std::size_t Count>
void warn_of_near_misses(const Json& extras,
                         const std::array<std::string_view, Count>& known,
                         const Place& place,
                         Warnings& warnings) {
    constexpr std::size_t kMaxEdits = 2;
    for (const auto& [key, value] : extras.items()) {
        std::string lower = key;
        std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
            return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
        });
        const bool is_known_alone =
            std::find(known.begin(), known.end(), lower) != known.end() && lower != "role";
        // A key takes memory in proportion to its length there; a longer one is not near.
        constexpr std::string_view kWanted = "acoustics";
        const bool is_near = key != kWanted && key.size() <= kWanted.size() + kMaxEdits &&
                             edit_distance(lower, kWanted) <= kMaxEdits;
        const bool is_bad_prefix = !key.starts_with(kFlatPrefix) && lower.starts_with("acoustic") &&
                                   lower.find('_') != std::string::npos;
        if (is_known_alone || is_near || is_bad_prefix) {
            warnings.push_back({place.file,
                                place.element + ": extras has a key \"" + key +
                                    "\" that means nothing here; write it below \"acoustics\", "
                                    "or as \"acoustics_library\" and its like"});
        }
    }
}

/// The acoustic data of a material or node: extras.acoustics and flat keys, which count where both
/// give the same; nothing if the object has neither.
template <std::size_t Count>
std::optional<Json> acoustics_of(const Json& object,
                                 const std::array<std::string_view, Count>& known,
                                 const Place& place,
                                 Warnings& warnings) {
    const auto extras = object.find("extras");
    if (extras == object.end() || !extras->is_object()) {
        return std::nullopt;
    }
    warn_of_near_misses(*extras, known, place, warnings);
    Json flat = flat_acoustics(*extras, place);
    if (!extras->contains("acoustics")) {
        return flat.empty() ? std::nullopt : std::optional(std::move(flat));
    }
    Json acoustics = unpacked((*extras)["acoustics"], place, "extras.acoustics");
    if (acoustics.is_string()) {
        // Of a material a library name, of a node what it is.
        acoustics = Json{{known.front(), acoustics}};
    }
    if (!acoustics.is_object()) {
        place.fail("extras.acoustics is neither a JSON object nor a name",
                   R"(write {"absorption": 0.1} or a library name)");
    }
    acoustics.update(flat);
    return acoustics;
}

template <std::size_t Count>
void warn_of_unknown_keys(const Json& acoustics,
                          const std::array<std::string_view, Count>& known,
                          const Place& place,
                          Warnings& warnings) {
    for (const auto& [key, value] : acoustics.items()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            warnings.push_back({place.file,
                                place.element + ": acoustic data has a key \"" + key +
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

constexpr std::array<std::string_view, 5> kMaterialKeys{
    "library", "absorption", "scattering", "transmission", "one_sided"};
constexpr std::array<std::string_view, 2> kNodeKeys{"role", "directivity"};

/// Blender writes yes and no as 1 and 0.
bool read_flag(const Json& flag, const char* key, const Place& place) {
    if (flag.is_boolean()) {
        return flag.get<bool>();
    }
    if (flag != 0 && flag != 1) {
        place.fail(std::string(key) + " is neither true nor false", "write true or false");
    }
    return flag == 1;
}

/// A library row, and what is given beside it in its place.
Material material_of(const Json& acoustics, const Place& place, Warnings& warnings) {
    warn_of_unknown_keys(acoustics, kMaterialKeys, place, warnings);
    Material material = default_material();
    if (acoustics.contains("library")) {
        material = library_material(acoustics["library"], place);
    }
    if (auto given = read_coefficient(acoustics, "absorption", place)) {
        material.absorption = std::move(*given);
    }
    if (auto given = read_coefficient(acoustics, "scattering", place)) {
        material.scattering = std::move(*given);
    }
    if (auto given = read_coefficient(acoustics, "transmission", place)) {
        material.transmission = std::move(*given);
    }
    if (acoustics.contains("one_sided")) {
        material.one_sided = read_flag(acoustics["one_sided"], "one_sided", place);
    }
    try {
        propagation::validate(material);
    } catch (const Error& error) {
        place.fail(error.what(), error.remedy());
    }
    return material;
}

}  // namespace

std::string nearest_library_names(const std::string& name) {
    constexpr std::size_t kSuggestions = 3;
    constexpr std::size_t kMaxNameLength = 100;  // no library name is near a longer one
    if (name.size() > kMaxNameLength) {
        return "see earshot materials";
    }
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

Material default_material() {
    Material material;
    material.absorption = EnergyCoefficient(0.1);
    material.scattering = EnergyCoefficient(0.1);
    return material;
}

ReadMaterial material_named(const std::string& name) {
    std::optional<Material> row = propagation::find_library_material(name);
    const bool is_known = row.has_value();
    ReadMaterial read{.material = is_known ? std::move(*row) : default_material(),
                      .is_default = !is_known,
                      .is_by_name = is_known};
    read.material.name = name;
    return read;
}

ReadMaterial read_material(const Json& json,
                           const std::string& name,
                           const std::string& file,
                           Warnings& warnings) {
    const Place place{file, "material \"" + name + "\""};
    const auto acoustics = acoustics_of(json, kMaterialKeys, place, warnings);
    if (!acoustics) {
        return material_named(name);
    }
    ReadMaterial read{.material = material_of(*acoustics, place, warnings)};
    read.material.name = name;
    return read;
}

Material read_acoustics(const Json& value,
                        const std::string& element,
                        const std::string& file,
                        Warnings& warnings) {
    const Place place{file, element};
    if (value.is_string()) {
        return library_material(value, place);
    }
    if (!value.is_object()) {
        place.fail("is neither a library name nor a JSON object",
                   R"(write "carpet-thin" or {"absorption": 0.1})");
    }
    return material_of(value, place, warnings);
}

NodeAcoustics read_node_acoustics(const Json& node,
                                  const std::string& name,
                                  const std::string& file,
                                  Warnings& warnings) {
    const Place place{file, "node \"" + name + "\""};
    const auto acoustics = acoustics_of(node, kNodeKeys, place, warnings);
    if (!acoustics) {
        return {};
    }
    warn_of_unknown_keys(*acoustics, kNodeKeys, place, warnings);
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
