// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/internal/moving_scene.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::collision {

/// Which patches of a mesh cannot touch themselves during a step (Volino and Magnenat-Thalmann
/// 1994; continuously: Tang, Curtis, Yoon and Manocha 2009). All triangles of a patch turn their
/// fronts to one direction throughout, so every line along it that meets the patch where it is not
/// at a border meets it as often as the projected border winds round it; and the border is one loop
/// whose projection never meets itself, so that is once or never. Both are tested with room for
/// rounding, for all times at once: normals and the sides of points on lines are quadratic in time,
/// and have a sign if their Bernstein coefficients do.
class SmoothPatches {
public:
    /// Finds the borders of the patches below the nodes of a new tree.
    void build(const MovingScene& scene, const SweptForest& forest);

    /// Follows the step.
    void update(const MovingScene& scene, const SweptForest& forest, Executor& executor);

    /// True only if no two elements of the node's triangles that share no vertex touch.
    bool is_free_of_contact(const MovingScene& scene,
                            const SweptForest& forest,
                            std::uint32_t node) const;

private:
    /// Bernstein coefficients of a triangle's normal, and what their rounding goes with.
    struct Normals {
        std::array<geometry::Vec3, 3> coefficients;
        double size = 0.0;
    };

    bool face_one_way(SlotRange slots, const geometry::Vec3& direction) const noexcept;

    std::vector<SlotRange> loop_of_node_;  // within vertices_; empty where there is not one loop
    std::vector<geometry::VertexId> vertices_;
    std::vector<Normals> normals_;      // by slot
    std::vector<geometry::Vec3> sums_;  // of normals half-way in the slots before
};

}  // namespace earshot::collision
