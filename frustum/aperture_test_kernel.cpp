// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/aperture_test.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/aperture_test_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/wide.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

HWY_INLINE std::uint32_t inside_bits(const ApertureTest& aperture,
                                     const PointBlock& block,
                                     std::size_t first) {
    Doubles offset[3], local[3];
    for (std::size_t k = 0; k < 3; ++k) {
        offset[k] = subtract(load(block.coordinate[k] + first), broadcast(aperture.apex[k]));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        local[axis] = add(add(multiply(offset[0], broadcast(aperture.axes[axis][0])),
                              multiply(offset[1], broadcast(aperture.axes[axis][1]))),
                          multiply(offset[2], broadcast(aperture.axes[axis][2])));
    }
    const Doubles depth = local[2];
    std::uint32_t inside = at_most_bits(broadcast(aperture.min_depth), depth);
    for (std::size_t k = 0; k < 2; ++k) {
        const Doubles margin = add(multiply(broadcast(aperture.margin_per_depth[k]), depth),
                                   broadcast(aperture.margin));
        const Doubles lower = subtract(multiply(broadcast(aperture.lower[k]), depth), margin);
        const Doubles upper = add(multiply(broadcast(aperture.upper[k]), depth), margin);
        inside &= at_most_bits(lower, local[k]) & at_most_bits(local[k], upper);
    }
    return inside;
}

void points_inside(const ApertureTest& aperture,
                   std::span<const PointBlock> blocks,
                   std::span<std::uint8_t> masks) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        std::uint32_t inside = 0;
        for (std::size_t first = 0; first < PointBlock::kWidth; first += lanes()) {
            inside |= inside_bits(aperture, blocks[i], first) << first;
        }
        masks[i] = static_cast<std::uint8_t>(inside);
    }
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(points_inside);

void find_points_inside(const ApertureTest& aperture,
                        std::span<const PointBlock> blocks,
                        std::span<std::uint8_t> masks) noexcept {
    HWY_DYNAMIC_DISPATCH(points_inside)(aperture, blocks, masks);
}

}  // namespace earshot::frustum
#endif
