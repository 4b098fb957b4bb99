// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/visibility/region.h"

#include <array>
#include <optional>

namespace earshot::visibility {

// Where guided visibility sampling (Wonka et al. 2006) sends its next rays.

using Corners = std::array<geometry::Vec3, 3>;

inline constexpr std::size_t kBorderPoints = 9;

/// Points about a triangle, in order, three at each corner: seen from `eye` they lie outside of it,
/// `angle` radians from its sides or corners (at the ends of its sides, and on the bisector of the
/// corner). The triangle may turn either side.
std::array<geometry::Vec3, kBorderPoints> enlarged(const geometry::Vec3& eye,
                                                   const Corners& triangle,
                                                   double angle) noexcept;

/// A ray that passed just by a triangle and met another one nearer than the triangle's plane.
struct BlockedRay {
    geometry::Ray ray{};        ///< by the triangle
    geometry::Vec3 hit{};       ///< where it was met
    Corners blocker{};          ///< what was met
    geometry::Vec3 old_hit{};   ///< on the triangle, seen from the same place
    geometry::Vec3 expected{};  ///< where the ray meets the triangle's plane
};

/// Where a ray meets a triangle's plane. Empty if it runs along it or away from it, or farther than
/// `most` metres.
std::optional<geometry::Vec3> expected_hit(const geometry::Ray& ray,
                                           const Corners& triangle,
                                           double most) noexcept;

/// A ray from the border of the region to what the blocker hides: past the blocker, `gap` metres
/// beside it in the plane of both rays. Empty if none does.
std::optional<geometry::Ray> reverse_ray(const BlockedRay& blocked,
                                         const ViewRegion& region,
                                         double gap) noexcept;

}  // namespace earshot::visibility
