// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/window_sight.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/window_sight_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/wide.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

HWY_INLINE std::uint32_t seen_of(const WindowSight& sight,
                                 const PointBlock& block,
                                 std::size_t first) {
    Doubles offset[3], local[3];
    for (std::size_t k = 0; k < 3; ++k) {
        offset[k] = subtract(load(block.coordinate[k] + first), broadcast(sight.apex[k]));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        local[axis] = add(add(multiply(offset[0], broadcast(sight.axes[axis][0])),
                              multiply(offset[1], broadcast(sight.axes[axis][1]))),
                          multiply(offset[2], broadcast(sight.axes[axis][2])));
    }
    const Doubles depth = local[2];
    std::uint32_t seen = at_most_bits(broadcast(sight.least_depth), depth);
    for (std::size_t k = 0; k < 2; ++k) {
        const Doubles room =
            add(multiply(broadcast(sight.share[k]), depth), broadcast(sight.reach));
        const Doubles lower = subtract(multiply(broadcast(sight.lower[k]), depth), room);
        const Doubles upper = add(multiply(broadcast(sight.upper[k]), depth), room);
        seen &= at_most_bits(lower, local[k]) & at_most_bits(local[k], upper);
    }
    return seen;
}

void in_sight(const WindowSight& sight,
              std::span<const PointBlock> blocks,
              std::span<std::uint8_t> masks) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        std::uint32_t seen = 0;
        for (std::size_t first = 0; first < PointBlock::kWidth; first += lanes()) {
            seen |= seen_of(sight, blocks[i], first) << first;
        }
        masks[i] = static_cast<std::uint8_t>(seen);
    }
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(in_sight);

void find_in_sight(const WindowSight& sight,
                   std::span<const PointBlock> blocks,
                   std::span<std::uint8_t> masks) noexcept {
    HWY_DYNAMIC_DISPATCH(in_sight)(sight, blocks, masks);
}

}  // namespace earshot::frustum
#endif
