// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/region.h"

#include <array>
#include <optional>

namespace earshot::visibility {

// The rays of guided visibility sampling (Wonka et al. 2006): adaptive border sampling and reverse
// sampling.

using geometry::Corners;

inline constexpr std::size_t kPolygonVertices = 9;

/// The vertices of the enlarged polygon around a triangle, in order, three at each corner: as seen
/// from `eye` they lie `angle` radians outside of its sides or corners (at the ends of its sides,
/// and on the bisector of the corner). The triangle may face either way.
std::array<geometry::Vec3, kPolygonVertices> enlarged_polygon(const geometry::Vec3& eye,
                                                              const Corners& triangle,
                                                              double angle) noexcept;

/// A ray past the border of a triangle that hit an occluder nearer than the triangle's plane.
struct BlockedRay {
    geometry::Ray ray{};        ///< past the triangle
    geometry::Vec3 hit{};       ///< where it hit the occluder
    Corners occluder{};         ///< the occluder
    geometry::Vec3 old_hit{};   ///< on the triangle, of a ray with the same origin
    geometry::Vec3 expected{};  ///< where the ray intersects the triangle's plane
};

/// The intersection of a ray with a triangle's plane. Empty if the ray runs along the plane or away
/// from it, or if the intersection is farther than `max_distance` metres.
std::optional<geometry::Vec3> expected_hit(const geometry::Ray& ray,
                                           const Corners& triangle,
                                           double max_distance) noexcept;

/// A ray from the boundary of the region to the point that the occluder hides, `gap` metres past
/// the occluder in the plane of both rays. Empty if there is none.
std::optional<geometry::Ray> reverse_ray(const BlockedRay& blocked,
                                         const ViewRegion& region,
                                         double gap) noexcept;

}  // namespace earshot::visibility
