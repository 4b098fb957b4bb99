// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/vec2.hpp>

namespace earshot::geometry {

/// A point seen along an axis.
inline glm::dvec2 drop(const Vec3& point, int axis) noexcept {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

}  // namespace earshot::geometry
