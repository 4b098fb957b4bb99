// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/discrete.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"

#include <optional>
#include <span>

namespace earshot::collision {

/// Penetration depth of two triangles that intersect.
struct PairDepth {
    /// Metres: the shortest translation along the normal of either triangle, to either side, after
    /// which they only touch, within 2^-44 of the longest edge. 0 for triangles that touch or are
    /// coplanar.
    double depth = 0.0;
    geometry::Vec3 move{0.0};  ///< of the first triangle, of that length, metres
};

/// Empty if neither triangle has an area. Precondition: they intersect.
std::optional<PairDepth> depth(const Corners& one, const Corners& other) noexcept;

/// The pair of triangles with the largest penetration depth.
struct Penetration {
    TrianglePair triangles{};
    PairDepth depth{};
    geometry::Segment cut{};  ///< intersection() of the two
};

/// The deepest of the pairs; of equally deep ones the first. It shows where surfaces penetrate
/// each other, and its move separates these two triangles: it does not separate the meshes, for
/// which surfaces alone do not tell what is inside (see convex.h for solids). Empty if there is no
/// pair in which a triangle has an area. Precondition: all pairs intersect, as those of
/// find_contacts() do.
std::optional<Penetration> deepest_penetration(const Body& a,
                                               const Body& b,
                                               std::span<const TrianglePair> contacts);

}  // namespace earshot::collision
