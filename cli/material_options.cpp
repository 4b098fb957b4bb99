// SPDX-License-Identifier: MIT
#include "earshot/cli/material_options.h"

#include "earshot/io/material_assignments.h"

#include <filesystem>

namespace earshot::cli {

void MaterialOptions::add_to(CLI::App& app) {
    add_repeatable(app,
                   "--material",
                   assignments_,
                   "'PATTERN=LIBRARY_NAME': acoustic data of the materials whose name matches a "
                   "shell pattern; the last match counts, after those of SCENE.materials.json")
        ->type_name("TEXT");
}

void MaterialOptions::apply(const std::string& scene_file, io::LoadedScene& loaded) const {
    std::vector<io::MaterialAssignment> assignments;
    const std::filesystem::path file = io::material_assignments_file(scene_file);
    if (std::filesystem::exists(file)) {
        assignments = io::read_material_assignments(file, loaded.acoustic_warnings);
    }
    for (const std::string& text : assignments_) {
        assignments.push_back(io::parse_material_assignment(text));
    }
    io::assign_materials(assignments, loaded);
}

}  // namespace earshot::cli
