// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/geometry/types.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

/// The unit vector along v; not finite for a zero vector.
inline geometry::Vec3 unit(const geometry::Vec3& v) noexcept {
    return v / std::sqrt(glm::dot(v, v));
}

/// The unit vector at a height along z, rotated about it by an angle in radians. Uniform heights
/// and angles make uniform directions: slices of a sphere of equal thickness have equal areas.
inline geometry::Vec3 on_sphere(double height, double turn) noexcept {
    const double radius = std::sqrt(std::max(0.0, 1.0 - height * height));
    return {radius * math::cos(turn), radius * math::sin(turn), height};
}

/// False if a component is infinite or not a number.
inline bool is_finite(const geometry::Vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace earshot::visibility
