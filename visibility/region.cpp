// SPDX-License-Identifier: MIT
#include "earshot/visibility/region.h"

#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

void validate(const ViewRegion& region) {
    const geometry::Vec3 size = region.size();
    if (!(size.x >= 0.0 && size.y >= 0.0 && size.z >= 0.0) || !std::isfinite(region.volume())) {
        throw Error("region",
                    "its corners are not in order, not finite or too far apart",
                    "give the lower corner first, in metres");
    }
}

geometry::Interval clip(const geometry::Vec3& origin,
                        const geometry::Vec3& step,
                        const ViewRegion& region,
                        geometry::Interval within) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (step[axis] == 0.0) {
            if (origin[axis] < region.lower[axis] || origin[axis] > region.upper[axis]) {
                return {1.0, 0.0};
            }
            continue;
        }
        const double lower = (region.lower[axis] - origin[axis]) / step[axis];
        const double upper = (region.upper[axis] - origin[axis]) / step[axis];
        within.min = std::max(within.min, std::min(lower, upper));
        within.max = std::min(within.max, std::max(lower, upper));
    }
    return within;
}

}  // namespace earshot::visibility
