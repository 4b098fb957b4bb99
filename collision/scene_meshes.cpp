// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/scene_meshes.h"

#include "earshot/collision/weld.h"

#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

namespace {

int animated_ancestor(const geometry::AnimatedMesh& scene, int node) {
    const auto is_animated = [](const geometry::Node& each) {
        return !each.translation.is_empty() || !each.rotation.is_empty() || !each.scale.is_empty();
    };
    while (node >= 0 && !is_animated(scene.nodes()[static_cast<std::size_t>(node)])) {
        node = scene.nodes()[static_cast<std::size_t>(node)].parent;
    }
    return node;
}

}  // namespace

SceneMeshes::SceneMeshes(geometry::AnimatedMesh scene, bool weld)
    : scene_(std::move(scene)),
      triangles_(scene_.mesh_names().size()),
      vertices_(scene_.mesh_names().size()) {
    // 1. The vertices of each mesh, and the index of each vertex in its mesh.
    std::vector<VertexId> index(scene_.vertex_count());
    for (VertexId vertex = 0; vertex < index.size(); ++vertex) {
        std::vector<VertexId>& own = vertices_[scene_.mesh_of_vertex()[vertex]];
        index[vertex] = static_cast<VertexId>(own.size());
        own.push_back(vertex);
    }
    // 2. Triangles of welded vertices, by mesh.
    std::vector<Triangle> triangles = scene_.triangles();
    if (weld) {
        replace_vertices(triangles, collision::weld(scene_));
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto& [a, b, c] = triangles[i];
        triangles_[scene_.mesh_of_triangle()[i]].push_back({index[a], index[b], index[c]});
    }
    find_rigid_nodes();
}

void SceneMeshes::find_rigid_nodes() {
    // 1. The node of all parts of a mesh.
    constexpr int kUnknown = -2;
    rigid_nodes_.assign(vertices_.size(), kUnknown);
    VertexId first = 0;
    for (const geometry::Part& part : scene_.parts()) {
        const int node =
            part.skin < 0 && part.targets.empty() ? animated_ancestor(scene_, part.node) : -1;
        for (VertexId i = 0; i < part.positions.size(); ++i) {
            int& known = rigid_nodes_[scene_.mesh_of_vertex()[first + i]];
            known = known == kUnknown || known == node ? node : -1;
        }
        first += static_cast<VertexId>(part.positions.size());
    }
    // 2. Boxes around the meshes in the space of their nodes.
    node_bounds_.assign(vertices_.size(), {Vec3(0.0), Vec3(0.0)});
    const std::vector<Vec3> positions = scene_.positions_at(0.0);
    for (std::size_t mesh = 0; mesh < vertices_.size(); ++mesh) {
        rigid_nodes_[mesh] = std::max(rigid_nodes_[mesh], -1);
        if (rigid_nodes_[mesh] < 0) {
            continue;
        }
        const glm::dmat4 to_node = glm::inverse(scene_.node_transform(rigid_nodes_[mesh], 0.0));
        auto& [lower, upper] = node_bounds_[mesh];
        lower = Vec3(std::numeric_limits<double>::infinity());
        upper = -lower;
        for (const VertexId vertex : vertices_[mesh]) {
            const Vec3 position(to_node * glm::dvec4(positions[vertex], 1.0));
            lower = glm::min(lower, position);
            upper = glm::max(upper, position);
        }
    }
}

std::vector<Vec3> SceneMeshes::positions(std::uint32_t mesh, std::span<const Vec3> of_scene) const {
    std::vector<Vec3> positions;
    positions.reserve(vertices_[mesh].size());
    for (const VertexId vertex : vertices_[mesh]) {
        positions.push_back(of_scene[vertex]);
    }
    return positions;
}

}  // namespace earshot::collision
