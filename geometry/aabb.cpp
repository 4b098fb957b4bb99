// SPDX-License-Identifier: MIT
#include "earshot/geometry/aabb.h"

#include <algorithm>

namespace earshot::geometry {

void Aabb::include(const Vec3& point) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        lower[k] = std::min(lower[k], round_down(point[axis]));
        upper[k] = std::max(upper[k], round_up(point[axis]));
    }
}

}  // namespace earshot::geometry
