// SPDX-License-Identifier: MIT
#include "earshot/scenes/picture.h"

#include "earshot/io/scene_picture.h"
#include "earshot/propagation/simulator.h"
#include "earshot/scenes/indexed_mesh.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace earshot::scenes {

namespace {

// A vector times `rotation`, written out: quaternion products of libraries may round otherwise.
Vec3 turned(const glm::dquat& rotation, const Vec3& vector) {
    const Vec3 axis(rotation.x, rotation.y, rotation.z);
    const Vec3 twist = glm::cross(axis, vector) + vector * rotation.w;
    return vector + glm::cross(axis, twist) * 2.0;
}

Vec3 posed(const DraftNode& node, const Vec3& rest) {
    Vec3 at = rest;
    if (!node.weights.times.empty()) {
        const auto& weights = node.weights.weights[node.weights.weights.size() / 2];
        for (std::size_t target = 0; target < node.morphs.size(); ++target) {
            at += node.morphs[target](rest) * weights[target];
        }
    }
    if (!node.rotation.times.empty()) {
        at = turned(node.rotation.rotations[node.rotation.rotations.size() / 2], at);
    }
    return at + node.translation;
}

// The scene at the middle of its key frames. Of its materials only the names are of interest.
propagation::Scene scene_of(const SceneDraft& draft) {
    propagation::Scene scene;
    scene.name = draft.name;
    for (const SurfaceMaterial& material : draft.materials) {
        scene.materials.push_back({.name = material.name});
    }
    geometry::Mesh mesh;
    for (const DraftNode& node : draft.nodes) {
        if (node.role == Role::source) {
            scene.sources.push_back({.name = node.name, .position = node.translation});
        } else if (node.role == Role::listener) {
            scene.listeners.push_back({.name = node.name, .position = node.translation});
        }
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        const IndexedMesh indexed = index_faces(node, draft.materials.size(), 1);
        for (const auto& [x, y, z] : indexed.positions) {
            mesh.positions.push_back(posed(node, {x, y, z}));
        }
        for (std::size_t material = 0; material < indexed.triangles.size(); ++material) {
            for (const auto& [a, b, c] : indexed.triangles[material]) {
                mesh.triangles.push_back({first + a, first + b, first + c});
                scene.material_of_triangle.push_back(static_cast<std::uint32_t>(material));
            }
        }
    }
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

// Dark enough for white paper.
std::string stroke(const std::array<double, 3>& colour) {
    std::string text = "rgb(";
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = 30.0 + 150.0 * std::sqrt(colour[i]) * colour[i];
        text += std::to_string(static_cast<int>(std::lround(value))) + (i < 2 ? "," : ")");
    }
    return text;
}

}  // namespace

std::string draw_picture(const SceneDraft& draft) {
    const propagation::Scene scene = scene_of(draft);
    propagation::Simulator simulator(scene, {.specular_order = 1});
    io::ScenePictureOptions options{.projection = io::Projection::isometric};
    for (const SurfaceMaterial& material : draft.materials) {
        options.colours.push_back(material.in_picture ? stroke(material.colour) : "");
    }
    return io::ScenePictures(scene, {0.0}, simulator.run(), std::move(options)).draw(0).svg;
}

}  // namespace earshot::scenes
