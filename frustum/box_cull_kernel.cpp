// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/box_cull.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/box_cull_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

bool box_lies_outside(const HalfSpaces& half_spaces, const float* lower, const float* upper) {
    const std::size_t step = Doubles::kCount;
    for (std::size_t i = 0; i < kMaxHalfSpaces; i += step) {
        Doubles farthest = Doubles(0.0);  // of the box's corners along each normal
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Doubles high = Doubles(static_cast<double>(upper[axis]));
            const Doubles low = Doubles(static_cast<double>(lower[axis]));
            farthest = farthest + Doubles::load(half_spaces.positive[axis] + i) * high;
            farthest = farthest + Doubles::load(half_spaces.negative[axis] + i) * low;
        }
        if (any(farthest < Doubles::load(half_spaces.offset + i))) {
            return true;
        }
    }
    return false;
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(box_lies_outside);

bool lies_outside(const HalfSpaces& half_spaces, const float* lower, const float* upper) {
    return HWY_DYNAMIC_DISPATCH(box_lies_outside)(half_spaces, lower, upper);
}

}  // namespace earshot::frustum
#endif
