// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace earshot::frustum {

/// A source or image less than this many rounding slacks from a facet's plane is not reflected:
/// with less, the slack allowed to the other end of the leg would move the reflection point by a
/// good part of the leg.
inline constexpr double kGrazingSlacks = 8.0;

/// Where a path turns in a plane.
struct Reflection {
    geometry::Vec3 point{0.0};
    bool is_front = true;  ///< on the side that the normal points to
};

/// The point where the leg from `target` towards the image `behind` meets the plane that mirrored
/// it from the image `before`. Nothing if that grazes the plane or `target` lies on the other side,
/// by more than `slack`. The one place where reflection points are computed: every path that is
/// reported has its points from here.
inline std::optional<Reflection> find_reflection(const geometry::Plane& plane,
                                                 const geometry::Vec3& before,
                                                 const geometry::Vec3& behind,
                                                 const geometry::Vec3& target,
                                                 double slack) noexcept {
    // Plane::distance, inline.
    const auto height_of = [&](const geometry::Vec3& point) {
        return glm::dot(plane.normal, point) - plane.offset;
    };
    const double height_before = height_of(before);  // its sign: the reflecting side
    const double height_behind = height_of(behind);
    const bool is_front = height_before > 0.0;
    double height = height_of(target);
    if (std::abs(height_before) <= kGrazingSlacks * slack ||
        (is_front ? height < -slack : height > slack)) {
        return std::nullopt;
    }
    height = is_front ? std::max(height, 0.0) : std::min(height, 0.0);
    return Reflection{target + (height / (height - height_behind)) * (behind - target), is_front};
}

}  // namespace earshot::frustum
