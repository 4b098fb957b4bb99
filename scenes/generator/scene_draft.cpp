// SPDX-License-Identifier: MIT
#include "earshot/scenes/scene_draft.h"

#include "earshot/base/error.h"
#include "earshot/propagation/material.h"

#include <utility>

namespace earshot::scenes {

std::size_t SceneDraft::library_material(const std::string& row, std::array<double, 3> colour) {
    for (std::size_t index = 0; index < materials.size(); ++index) {
        if (materials[index].library == row) {
            return index;
        }
    }
    if (!propagation::find_library_material(row)) {
        throw Error(row, "is no row of the material library", "see earshot materials");
    }
    SurfaceMaterial material;
    material.name = row;
    material.library = row;
    material.colour = colour;
    materials.push_back(std::move(material));
    return materials.size() - 1;
}

std::size_t SceneDraft::plain_material(std::string material_name, double absorption) {
    SurfaceMaterial material;
    material.name = std::move(material_name);
    material.absorption = absorption;
    materials.push_back(std::move(material));
    return materials.size() - 1;
}

void SceneDraft::add_geometry(std::string node_name, Faces faces) {
    DraftNode node;
    node.name = std::move(node_name);
    node.faces = std::move(faces);
    nodes.push_back(std::move(node));
}

void SceneDraft::add_source(std::string node_name, const Vec3& position) {
    DraftNode node;
    node.name = std::move(node_name);
    node.translation = position;
    node.role = Role::source;
    nodes.push_back(std::move(node));
}

void SceneDraft::add_listener(std::string node_name, const Vec3& position) {
    add_source(std::move(node_name), position);
    nodes.back().role = Role::listener;
}

}  // namespace earshot::scenes
