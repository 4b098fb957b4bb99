// SPDX-License-Identifier: MIT
#include "earshot/visibility/region.h"

#include <algorithm>

namespace earshot::visibility {

Passage passage(const geometry::Vec3& origin,
                const geometry::Vec3& step,
                const Region& region,
                Passage within) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (step[axis] == 0.0) {
            if (origin[axis] < region.lower[axis] || origin[axis] > region.upper[axis]) {
                return {1.0, 0.0};
            }
            continue;
        }
        const double lower = (region.lower[axis] - origin[axis]) / step[axis];
        const double upper = (region.upper[axis] - origin[axis]) / step[axis];
        within.begin = std::max(within.begin, std::min(lower, upper));
        within.end = std::min(within.end, std::max(lower, upper));
    }
    return within;
}

}  // namespace earshot::visibility
