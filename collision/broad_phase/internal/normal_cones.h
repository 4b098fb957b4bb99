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

/// Continuous normal cones: which nodes of the BVH have no self-contact during a step (Volino and
/// Magnenat-Thalmann 1994; continuous: Tang, Curtis, Yoon and Manocha 2009). Two tests:
///   cone     all normals of the node's triangles keep a positive component along one axis during
///            the step, so a line along that axis intersects the surface as often as the projected
///            contour winds round it;
///   contour  the border of the surface is one loop whose projection along the axis never
///            intersects itself, so that the winding number is at most 1.
/// Both hold for all times of the step: normals, and the sides of points about lines, are quadratic
/// in time and have one sign if their Bernstein coefficients do; rounding errors are bounded.
class NormalCones {
public:
    /// Finds the contours of the nodes of a new tree.
    void build(const MovingScene& scene, const SweptBvh& swept_bvh);

    /// Follows the step: the normals of meshes that do not move as in the last one.
    void update(const MovingScene& scene, const SweptBvh& swept_bvh, Executor& executor);

    /// True only if no two elements of the node's triangles that share no vertex are in contact.
    bool is_contact_free(const MovingScene& scene,
                         const SweptBvh& swept_bvh,
                         std::uint32_t node) const;

private:
    /// Bernstein coefficients of a triangle's normal; their rounding error is relative to `size`.
    struct Normals {
        std::array<geometry::Vec3, 3> coefficients;
        double size = 0.0;
    };

    bool passes_cone_test(SlotRange slots, const geometry::Vec3& direction) const noexcept;

    std::vector<SlotRange> contour_of_node_;  // within vertices_; empty where it is not one loop
    std::vector<geometry::VertexId> vertices_;
    std::vector<Normals> normals_;      // by slot
    std::vector<geometry::Vec3> sums_;  // prefix sums by slot of the normals half-way
    ChangedMeshes changed_meshes_;
};

}  // namespace earshot::collision
