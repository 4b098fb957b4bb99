// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/vec2.hpp>

namespace earshot::geometry {

/// The point projected to 2-D along an axis: the other two coordinates, in cyclic order.
inline glm::dvec2 project_along(const Vec3& point, int axis) noexcept {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

}  // namespace earshot::geometry
