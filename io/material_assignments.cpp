// SPDX-License-Identifier: MIT
#include "earshot/io/material_assignments.h"

#include "earshot/io/internal/acoustics_extras.h"
#include "earshot/io/internal/json_depth.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fnmatch.h>

namespace earshot::io {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson parse(const std::filesystem::path& file) {
    const std::string text = read_whole_file(file);
    if (exceeds_json_depth(text)) {
        throw Error(file.string(),
                    "is nested more than " + std::to_string(kMaxJsonDepth) + " levels deep",
                    "mend the file");
    }
    OrderedJson json;
    try {
        json = OrderedJson::parse(text);
    } catch (const nlohmann::json::exception& error) {
        throw Error(file.string(), std::string("is not JSON: ") + error.what(), "mend the file");
    }
    if (!json.is_object()) {
        throw Error(file.string(),
                    "is not a JSON object",
                    R"(write {"PATTERN": "LIBRARY NAME"}, as in {"Carpet*": "carpet-thin"})");
    }
    return json;
}

bool matches(const std::string& pattern, const std::string& name) {
    return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

/// At most a dozen names, for a message.
std::string names_of(const std::vector<propagation::Material>& materials) {
    constexpr std::size_t kMaxNames = 12;
    std::string text;
    for (std::size_t i = 0; i < std::min(kMaxNames, materials.size()); ++i) {
        text += (i == 0 ? "" : ", ") + materials[i].name;
    }
    return materials.size() > kMaxNames ? text + ", ..." : text;
}

}  // namespace

MaterialAssignment parse_material_assignment(std::string_view text) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size()) {
        throw Error("--material",
                    "'" + std::string(text) + "' is not of the form PATTERN=LIBRARY_NAME",
                    "write it as in --material 'Carpet*=carpet-thin'");
    }
    Warnings warnings;
    return {.pattern = std::string(text.substr(0, equals)),
            .material = read_acoustics(std::string(text.substr(equals + 1)),
                                       "pattern \"" + std::string(text.substr(0, equals)) + "\"",
                                       "--material",
                                       warnings),
            .origin = "--material"};
}

std::vector<MaterialAssignment> read_material_assignments(const std::filesystem::path& file,
                                                          Warnings& warnings) {
    std::vector<MaterialAssignment> assignments;
    const OrderedJson json = parse(file);
    for (const auto& [pattern, value] : json.items()) {
        // The reader of acoustic data takes JSON whose keys are sorted.
        const auto acoustics = nlohmann::json::parse(value.dump());
        assignments.push_back(
            {.pattern = pattern,
             .material =
                 read_acoustics(acoustics, "pattern \"" + pattern + "\"", file.string(), warnings),
             .origin = file.string()});
    }
    return assignments;
}

std::filesystem::path material_assignments_file(const std::filesystem::path& scene) {
    return scene.parent_path() / (scene.stem().string() + ".materials.json");
}

void assign_materials(const std::vector<MaterialAssignment>& assignments, LoadedScene& loaded) {
    std::vector<propagation::Material>& materials = loaded.scene.materials;
    for (const MaterialAssignment& assignment : assignments) {
        bool has_match = false;
        for (std::size_t i = 0; i < materials.size(); ++i) {
            if (!matches(assignment.pattern, materials[i].name)) {
                continue;
            }
            std::string name = std::move(materials[i].name);
            materials[i] = assignment.material;
            materials[i].name = std::move(name);
            std::erase(loaded.default_materials, static_cast<std::uint32_t>(i));
            std::erase(loaded.materials_by_name, static_cast<std::uint32_t>(i));
            has_match = true;
        }
        if (!has_match) {
            loaded.acoustic_warnings.push_back({assignment.origin,
                                                "no material of the scene matches \"" +
                                                    assignment.pattern +
                                                    "\"; its materials: " + names_of(materials)});
        }
    }
}

}  // namespace earshot::io
