// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace earshot::visibility {

/// The vector at length 1; not finite if it has no direction.
inline geometry::Vec3 unit(const geometry::Vec3& v) noexcept {
    return v / std::sqrt(glm::dot(v, v));
}

/// False for infinities and what is not a number.
inline bool is_finite(const geometry::Vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace earshot::visibility
