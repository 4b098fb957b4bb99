// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/aperture_test.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/aperture_test_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

HWY_INLINE std::uint32_t inside_bits(const ApertureTest& aperture,
                                     const PointBlock& block,
                                     std::size_t first) {
    Doubles offset[3], local[3];
    for (std::size_t k = 0; k < 3; ++k) {
        offset[k] = Doubles::load(block.coordinate[k] + first) - Doubles(aperture.apex[k]);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        local[axis] = offset[0] * Doubles(aperture.axes[axis][0]) +
                      offset[1] * Doubles(aperture.axes[axis][1]) +
                      offset[2] * Doubles(aperture.axes[axis][2]);
    }
    const Doubles depth = local[2];
    std::uint32_t inside = bits(Doubles(aperture.min_depth) <= depth);
    for (std::size_t k = 0; k < 2; ++k) {
        const Doubles margin =
            Doubles(aperture.margin_per_depth[k]) * depth + Doubles(aperture.margin);
        const Doubles lower = Doubles(aperture.lower[k]) * depth - margin;
        const Doubles upper = Doubles(aperture.upper[k]) * depth + margin;
        inside &= bits(lower <= local[k]) & bits(local[k] <= upper);
    }
    return inside;
}

void points_inside(const ApertureTest& aperture,
                   std::span<const PointBlock> blocks,
                   std::span<std::uint8_t> masks) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        std::uint32_t inside = 0;
        for (std::size_t first = 0; first < PointBlock::kWidth; first += Doubles::kCount) {
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
