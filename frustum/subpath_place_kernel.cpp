// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_place.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/subpath_place_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

// The two lanes that are no coordinates come along and are not looked at.
Spread widest(std::span<const SubpathPlace> places) {
    static_assert(sizeof(SubpathPlace) == Float8::kCount * sizeof(float));
    const auto lanes_of = [](const SubpathPlace& place) {
        return Float8::load(place.coordinate.data());
    };
    Float8 low = lanes_of(places.front());
    Float8 high = low;
    for (const SubpathPlace& place : places) {
        const Float8 here = lanes_of(place);
        low = min(low, here);
        high = max(high, here);
    }
    alignas(32) float lower[Float8::kCount], upper[Float8::kCount], size[Float8::kCount];
    low.store(lower);
    high.store(upper);
    (high - low).store(size);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < kPlaceCoordinates; ++k) {
        axis = size[k] > size[axis] ? k : axis;
    }
    return {axis, lower[axis], upper[axis]};
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(widest);

Spread widest_spread(std::span<const SubpathPlace> places) noexcept {
    return HWY_DYNAMIC_DISPATCH(widest)(places);
}

}  // namespace earshot::frustum
#endif
