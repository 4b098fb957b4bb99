// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/vec2.hpp>

namespace earshot::geometry {

/// Coordinates of a smaller magnitude, 2^-298 (about 2e-90), are out of range of the predicates:
/// products of three of them would underflow.
inline constexpr double kMinCoordinate = 0x1p-298;

/// The same point, with 0 for coordinates below kMinCoordinate.
Vec3 without_tiny_coordinates(const Vec3& point) noexcept;

/// Sign of the determinant of (b - a, c - a): +1 if a, b, c turn left, -1 right, 0 collinear.
/// Exact: a floating-point filter decides most cases, expansions the rest (Shewchuk 1997, section
/// 4). Precondition: coordinates are finite and products of three of them neither overflow nor
/// underflow (1e-90 < |x| < 1e90 or 0).
int orient2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept;

/// Sign of the determinant of (a - d, b - d, c - d): +1 if d lies below the plane through a, b, c,
/// that is, a, b, c run counter-clockwise seen from above; 0 coplanar. Exact, as orient2d.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept;

/// Whether a triangle has an area: false if its corners lie on a line or in a point. Exact, as
/// orient2d.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// The determinants whose signs these are, with the same signs and within 2^-39 of their exact
/// values, relatively: for ratios of distances to a line or plane. Same preconditions.
double determinant2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept;
double determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept;

}  // namespace earshot::geometry
