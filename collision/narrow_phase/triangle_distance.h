// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/triangle_intersection.h"

namespace earshot::collision {

/// How far apart two triangles are, and where.
struct TriangleDistance {
    double distance = 0.0;       ///< metres; 0 if and only if they intersect
    geometry::Vec3 on_one{0.0};  ///< the closest points, metres
    geometry::Vec3 on_other{0.0};

    friend bool operator==(const TriangleDistance&, const TriangleDistance&) = default;
};

/// Within 2^-44 of the distance and of the longest edge together, never less than the true distance
/// by more than that; the points are as close to each other as that. Of triangles that intersect
/// both points are the beginning of intersection(). Triangles without area are segments or points.
/// Preconditions: magnitudes of coordinates between 1e-70 and 1e70, or 0.
TriangleDistance distance(const Corners& one, const Corners& other) noexcept;

/// The same for triangles that are known to be disjoint; of others, the distance of their borders.
TriangleDistance distance_of_disjoint(const Corners& one, const Corners& other) noexcept;

}  // namespace earshot::collision
