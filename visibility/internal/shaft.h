// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/internal/viewer_region.h"

#include <array>
#include <cstddef>

namespace earshot::visibility {

/// The convex hull of a region of viewers and a box, which holds all lines of sight from one to the
/// other (Haines and Wallace 1991, shaft culling). Tests err to the side of true.
class Shaft {
public:
    /// `max_abs_coordinate`: at least that of all that will be tested. Precondition: no box is
    /// empty, all is finite.
    Shaft(const ViewerRegion& viewer, const geometry::Aabb& to, double max_abs_coordinate) noexcept;

    /// False only if nothing in the box touches the shaft.
    bool may_touch(const geometry::Aabb& box) const noexcept;
    /// False only if the triangle does not.
    bool may_touch(const geometry::Corners& triangle) const noexcept;

private:
    /// Of three pairs of axes, four quadrants, two sides in each.
    static constexpr std::size_t kMaxPlanes = 24;

    /// A plane that is parallel to an axis and has all boxes behind it.
    struct SupportingPlane {
        std::size_t i = 0, j = 0;  // the other two axes
        double normal_i = 0.0, normal_j = 0.0;
        double limit = 0.0;  // normal . point is at most this in the shaft
    };

    void add_planes(std::size_t i, std::size_t j, double margin) noexcept;
    /// Adds the plane through a corner of a box, if it supports all boxes.
    void add_plane(SupportingPlane plane, const geometry::Aabb& through, double margin) noexcept;
    bool is_beside_plane_of(const geometry::Corners& triangle) const noexcept;

    std::array<geometry::Aabb, 3> boxes_;
    bool is_point_;
    std::array<double, 3> lower_{}, upper_{};  // of all boxes, a margin outside
    std::array<SupportingPlane, kMaxPlanes> planes_{};
    std::size_t plane_count_ = 0;
};

}  // namespace earshot::visibility
