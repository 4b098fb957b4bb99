// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <optional>

namespace earshot::collision {

using geometry::Corners;

/// Whether two closed triangles share a point, decided exactly: touching at a corner or an edge
/// counts, and so does overlap in one plane. Triangles without area are segments or points.
/// Preconditions: coordinates as geometry::orient3d() asks.
bool intersect(const Corners& one, const Corners& other) noexcept;

/// The two points farthest apart among those that both triangles have; of triangles in one plane,
/// of a segment's length and more, these span their common polygon. `from` comes before `to` by x,
/// then y, then z; they are equal where there is a single point. Empty if the triangles do not
/// intersect, decided as intersect() does. Points that are corners are exact; others lie within
/// 2^-36 of the longest edge of both from where they should be. Preconditions as intersect().
std::optional<geometry::Segment> intersection(const Corners& one, const Corners& other) noexcept;

}  // namespace earshot::collision
