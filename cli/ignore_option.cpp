// SPDX-License-Identifier: MIT
#include "earshot/cli/ignore_option.h"

#include "earshot/cli/scene_choice.h"

#include <cstdint>

namespace earshot::cli {

void IgnoreOption::add_to(CLI::App& app) {
    add_repeatable(app, "--ignore", names_, "a material that is looked through; may be repeated");
}

visibility::ExclusionMask IgnoreOption::mask_for(const propagation::Scene& scene) const {
    std::vector<std::uint32_t> materials;
    for (const std::string& name : names_) {
        materials.push_back(material_named(scene, name));
    }
    return visibility::ExclusionMask::of_materials(scene.material_of_triangle, materials);
}

}  // namespace earshot::cli
