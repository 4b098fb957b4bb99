// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/io/scene_file.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// Acoustic data for all materials of a scene whose name matches a shell pattern (* any text, ? any
/// character, [abc] or [a-z] or [!a-z] one of a set; upper and lower case differ).
struct MaterialAssignment {
    std::string pattern;
    propagation::Material material;
    std::string origin;  ///< the option or file that gave it, for warnings
};

/// An option's `PATTERN=LIBRARY_NAME`. Throws Error if it is not of the form, or for names that the
/// library does not have.
MaterialAssignment parse_material_assignment(std::string_view text);

/// A JSON file whose keys are patterns, in its order: {"Carpet*": "carpet-thin",
/// "Wall": {"absorption": {"125": 0.1}, "scattering": 0.2}}, each value as in extras.acoustics of
/// a glTF material. Throws Error naming file and pattern.
std::vector<MaterialAssignment> read_material_assignments(const std::filesystem::path& file,
                                                          Warnings& warnings);

/// The materials as the text of such a file, each under a pattern that matches its name alone. Of
/// several with one name the last counts.
std::string encode_materials(std::span<const propagation::Material> materials);

/// `room.materials.json` beside `room.obj`.
std::filesystem::path material_assignments_file(const std::filesystem::path& scene);

/// Gives every material of the scene the data of the last assignment that matches its name; the
/// name stays, and it is no longer one of the default materials. A pattern that matches no material
/// is an acoustic warning with the names there are.
void assign_materials(const std::vector<MaterialAssignment>& assignments, LoadedScene& loaded);

}  // namespace earshot::io
