// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/normal_cones.h"

#include "earshot/collision/broad_phase/internal/border_loops.h"
#include "earshot/collision/broad_phase/internal/contour.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// Smaller ones are tested pair by pair sooner than proven smooth.
constexpr std::uint32_t kLeastTriangles = 8;

double largest(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

void SmoothPatches::build(const MovingScene& scene, const SweptForest& forest) {
    BorderLoops loops = border_loops(scene, forest, kLeastTriangles);
    loop_of_node_ = std::move(loops.of_node);
    vertices_ = std::move(loops.vertices);
}

void SmoothPatches::update(const MovingScene& scene,
                           const SweptForest& forest,
                           Executor& executor) {
    normals_.resize(scene.triangles.size());
    executor.for_each(normals_.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t slot = from; slot < to; ++slot) {
            const MovingCorners corners = scene.corners_of(
                scene.triangles[forest.triangle(static_cast<std::uint32_t>(slot))]);
            const Vec3 a = corners.begin[1] - corners.begin[0];
            const Vec3 b = corners.begin[2] - corners.begin[0];
            const Vec3 c = corners.end[1] - corners.end[0];
            const Vec3 d = corners.end[2] - corners.end[0];
            normals_[slot].coefficients = {
                glm::cross(a, b), 0.5 * (glm::cross(a, d) + glm::cross(c, b)), glm::cross(c, d)};
            normals_[slot].size =
                std::max(largest(a), largest(c)) * std::max(largest(b), largest(d));
        }
    });
    sums_.resize(normals_.size() + 1);
    for (std::size_t slot = 0; slot < normals_.size(); ++slot) {
        sums_[slot + 1] = sums_[slot] + normals_[slot].coefficients[1];
    }
}

bool SmoothPatches::face_one_way(SlotRange slots, const Vec3& direction) const noexcept {
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Normals& normals = normals_[slot];
        // Far above what rounding does to products of this size, and to the direction.
        const double room = 0x1p-40 * normals.size + 1e-290;
        for (const Vec3& normal : normals.coefficients) {
            if (!(glm::dot(normal, direction) > room)) {
                return false;
            }
        }
    }
    return true;
}

bool SmoothPatches::is_free_of_contact(const MovingScene& scene,
                                       const SweptForest& forest,
                                       std::uint32_t node) const {
    const SlotRange loop = loop_of_node_[node];
    if (loop.begin == loop.end) {
        return false;
    }
    const SlotRange slots = forest.slots_of_node(node);
    const Vec3 sum = sums_[slots.end] - sums_[slots.begin];
    const Vec3 direction = unit_or_zero(sum);
    return face_one_way(slots, direction) &&
           !meets_itself(
               scene, std::span(vertices_).subspan(loop.begin, loop.end - loop.begin), direction);
}

}  // namespace earshot::collision
