// SPDX-License-Identifier: MIT
#include "earshot/visibility/region.h"

#include <algorithm>

namespace earshot::visibility {

Passage passage(const geometry::Segment& segment, const Region& region) noexcept {
    constexpr Passage kNone = {1.0, 0.0};
    Passage inside;
    for (int axis = 0; axis < 3; ++axis) {
        const double from = segment.from[axis];
        const double step = segment.to[axis] - from;
        if (step == 0.0) {
            if (from < region.lower[axis] || from > region.upper[axis]) {
                return kNone;
            }
            continue;
        }
        const double lower = (region.lower[axis] - from) / step;
        const double upper = (region.upper[axis] - from) / step;
        inside.begin = std::max(inside.begin, std::min(lower, upper));
        inside.end = std::min(inside.end, std::max(lower, upper));
    }
    return inside;
}

}  // namespace earshot::visibility
