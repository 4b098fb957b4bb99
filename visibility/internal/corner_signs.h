// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace earshot::visibility {

// Signs of determinants over all points of boxes, in double precision with bounds of the rounding.
// A determinant is affine in each point, so that its extremes lie at corners of the boxes.

/// Of a sum of three products of a normal, taken as it is, and coordinates: each is off by at most
/// 3 * 2^-53 of it, their sum by no more than 6 * 2^-53 of all together, on two sides.
inline constexpr double kPlaneError = 0x1p-49;

/// Of (b - a) x (c - a) . (p - a), relative to the product of the largest components of the three
/// differences: the differences are off by 2^-53 of themselves, the six products of three factors
/// by less than 8 * 2^-53 each, and adding them up by less than 40 * 2^-53 more, together below
/// 128 * 2^-53. A corner that is the wrong one because a component of the normal has the wrong sign
/// adds less than 64 * 2^-53.
inline constexpr double kDeterminantError = 0x1p-44;

/// Shorter differences, in metres, decide nothing: the exact tests take coordinates below 2^-298 as
/// 0 (geometry::kMinCoordinate), which shifts determinants by less than kDeterminantError if no
/// difference is below this.
inline constexpr double kMinExtent = 0x1p-200;

/// A corner of a box: upper along the axes whose flags are set.
inline geometry::Vec3 corner(const geometry::Aabb& box, std::size_t flags) noexcept {
    return {(flags & 1U) != 0 ? box.upper[0] : box.lower[0],
            (flags & 2U) != 0 ? box.upper[1] : box.lower[1],
            (flags & 4U) != 0 ? box.upper[2] : box.lower[2]};
}

/// The corner that lies farthest along a direction.
inline geometry::Vec3 farthest_corner(const geometry::Aabb& box,
                                      const geometry::Vec3& direction) noexcept {
    return {direction.x > 0.0 ? box.upper[0] : box.lower[0],
            direction.y > 0.0 ? box.upper[1] : box.lower[1],
            direction.z > 0.0 ? box.upper[2] : box.lower[2]};
}

/// The largest absolute component of box - point.
inline double max_distance(const geometry::Aabb& box, const geometry::Vec3& point) noexcept {
    return std::max(geometry::max_abs(corner(box, 0) - point),
                    geometry::max_abs(corner(box, 7) - point));
}

/// The largest absolute values of the components of box - point.
inline geometry::Vec3 max_distances(const geometry::Aabb& box,
                                    const geometry::Vec3& point) noexcept {
    return glm::max(glm::abs(corner(box, 0) - point), glm::abs(corner(box, 7) - point));
}

/// On which side of the plane through a point and two others a whole box lies: +1 where the
/// determinant is positive for sure, -1 where it is negative, 0 if it is neither.
class TrianglePlane {
public:
    explicit TrianglePlane(const geometry::Corners& points) noexcept : origin_(points[0]) {
        const geometry::Vec3 u = points[1] - points[0];
        const geometry::Vec3 v = points[2] - points[0];
        normal_ = glm::cross(u, v);
        const double size_u = geometry::max_abs(u);
        const double size_v = geometry::max_abs(v);
        is_valid_ = size_u > kMinExtent && size_v > kMinExtent;
        size_ = size_u * size_v;
    }

    /// `slack`: what the determinant may be off by for other reasons than rounding, >= 0.
    int side(const geometry::Aabb& box, double slack = 0.0) const noexcept {
        const double extent = max_distance(box, origin_);
        if (!is_valid_ || !(extent > kMinExtent)) {
            return 0;
        }
        const double margin = kDeterminantError * size_ * extent + slack;
        if (glm::dot(normal_, farthest_corner(box, -normal_) - origin_) > margin) {
            return 1;
        }
        return glm::dot(normal_, farthest_corner(box, normal_) - origin_) < -margin ? -1 : 0;
    }

private:
    geometry::Vec3 origin_, normal_{0.0};
    double size_ = 0.0;
    bool is_valid_ = false;
};

}  // namespace earshot::visibility
