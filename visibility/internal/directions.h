// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/geometry/types.h"

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

/// The unit vector at a height along z, rotated about it by an angle in radians. Uniform heights
/// and angles make uniform directions: slices of a sphere of equal thickness have equal areas.
inline geometry::Vec3 on_sphere(double height, double turn) noexcept {
    const double radius = std::sqrt(std::max(0.0, 1.0 - height * height));
    return {radius * math::cos(turn), radius * math::sin(turn), height};
}

}  // namespace earshot::visibility
