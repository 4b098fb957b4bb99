// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/intersect.h"
#include "earshot/io/scene_file.h"

#include <glm/common.hpp>

#include "support/dice.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace earshot::visibility {

// Scenes, segments that are hard to decide, and answers without a hierarchy.

inline const std::array<std::string, 5> kSceneNames{
    "shoebox", "lroom", "classroom", "coupled_rooms", "concert_hall"};

inline geometry::Mesh scene_mesh(const std::string& name) {
    const auto loaded = io::load_scene(test::source_file("scenes/" + name + ".gltf"));
    return {loaded.scene.mesh.positions_at(0.0), loaded.scene.mesh.triangles()};
}

inline bvh::WideTree wide_tree_of(const geometry::MeshView& mesh,
                                  const bvh::BuildOptions& options = {}) {
    return bvh::WideTree::build(bvh::Tree::build(bvh::triangle_boxes(mesh), options), mesh);
}

/// A segment from anywhere to anywhere in the mesh's box, through a vertex, from or to one, along
/// an edge or beyond its ends, or in the plane of a triangle.
inline geometry::Segment some_segment(const geometry::MeshView& mesh, support::Dice& dice) {
    using geometry::Vec3;
    static constexpr int kKinds = 8;
    Vec3 lower = mesh.positions[0], upper = lower;
    for (const Vec3& p : mesh.positions) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    const auto anywhere = [&] {
        return Vec3(dice.between(lower.x, upper.x),
                    dice.between(lower.y, upper.y),
                    dice.between(lower.z, upper.z));
    };
    const auto& triangle = mesh.triangles[static_cast<std::size_t>(
        dice.below(static_cast<int>(mesh.triangles.size())))];
    const auto first = static_cast<std::size_t>(dice.below(3));
    const Vec3 a = mesh.positions[triangle[first]];
    const Vec3 b = mesh.positions[triangle[(first + 1) % 3]];
    const Vec3 c = mesh.positions[triangle[(first + 2) % 3]];
    const auto in_plane = [&] {
        const double u = dice.below(9) / 4.0 - 0.5, v = dice.below(9) / 4.0 - 0.5;
        return a + u * (b - a) + v * (c - a);
    };
    switch (dice.below(kKinds)) {
        case 0: {  // through a vertex
            const Vec3 step = 0.25 * (anywhere() - a);
            return {a - step, a + step};
        }
        case 1:
            return {a, anywhere()};
        case 2:
            return {anywhere(), 0.5 * (a + b)};
        case 3:
            return {a + 0.25 * (a - b), b + 0.25 * (b - a)};
        case 4:
            return {0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b};
        case 5:
            return {in_plane(), in_plane()};
        default:
            return {anywhere(), anywhere()};
    }
}

/// Whether triangle `id` shares a point with the segment; cheap where their boxes are apart.
inline bool blocks(const geometry::MeshView& mesh,
                   geometry::TriangleId id,
                   const geometry::Segment& s) {
    const geometry::Triangle& t = mesh.triangles[id];
    const geometry::Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]],
                         &c = mesh.positions[t[2]];
    for (int k = 0; k < 3; ++k) {
        if (std::max({a[k], b[k], c[k]}) < std::min(s.from[k], s.to[k]) ||
            std::min({a[k], b[k], c[k]}) > std::max(s.from[k], s.to[k])) {
            return false;
        }
    }
    return geometry::touches(s, a, b, c);
}

/// All triangles one by one; triangles with `is_excluded(id)` are left out.
template <typename IsExcluded>
bool visible_by_brute_force(const geometry::MeshView& mesh,
                            const geometry::Segment& segment,
                            IsExcluded&& is_excluded) {
    for (geometry::TriangleId id = 0; id < mesh.triangles.size(); ++id) {
        if (!is_excluded(id) && blocks(mesh, id, segment)) {
            return false;
        }
    }
    return true;
}

}  // namespace earshot::visibility
