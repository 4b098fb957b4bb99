// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/animated_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace earshot::collision {

/// An animated mesh split into its meshes, each with vertices of its own.
class SceneMeshes {
public:
    /// `weld`: vertices of one mesh that are at one position at every instant are one.
    SceneMeshes(geometry::AnimatedMesh scene, bool weld);

    const geometry::AnimatedMesh& scene() const noexcept { return scene_; }
    std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(vertices_.size()); }

    /// Of a mesh: vertex indices count its vertices in their order in the scene.
    std::span<const geometry::Triangle> triangles(std::uint32_t mesh) const noexcept {
        return triangles_[mesh];
    }
    std::size_t vertex_count(std::uint32_t mesh) const noexcept { return vertices_[mesh].size(); }

    /// The animated node with which all vertices of a mesh move, without skin and morph targets:
    /// the closest one above the mesh. -1: none.
    int rigid_node(std::uint32_t mesh) const noexcept { return rigid_nodes_[mesh]; }
    /// The lower and upper corner of a box around a mesh in the space of that node.
    std::array<geometry::Vec3, 2> node_bounds(std::uint32_t mesh) const noexcept {
        return node_bounds_[mesh];
    }

    /// Positions of a mesh's vertices, given those of the scene.
    std::vector<geometry::Vec3> positions(std::uint32_t mesh,
                                          std::span<const geometry::Vec3> of_scene) const;

private:
    void find_rigid_nodes();

    geometry::AnimatedMesh scene_;
    std::vector<std::vector<geometry::Triangle>> triangles_;
    std::vector<std::vector<geometry::VertexId>> vertices_;  // of each mesh, in the scene
    std::vector<int> rigid_nodes_;
    std::vector<std::array<geometry::Vec3, 2>> node_bounds_;
};

}  // namespace earshot::collision
