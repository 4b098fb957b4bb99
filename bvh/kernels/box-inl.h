// SPDX-License-Identifier: MIT
//
// Boxes in registers, compiled once per instruction set; see base/simd/lanes-inl.h. Nothing is
// fused, so every set computes the same bits from numbers.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/internal/build_box.h"

#include <limits>

#if defined(EARSHOT_BVH_KERNELS_BOX_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_BOX_INL_H
#undef EARSHOT_BVH_KERNELS_BOX_INL_H
#else
#define EARSHOT_BVH_KERNELS_BOX_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the lanes

/// The largest float.
constexpr float kHighest = std::numeric_limits<float>::max();

/// A BuildBox in registers: four negated minima, then four maxima.
using Box = Float8;

HWY_INLINE Box load_box(const BuildBox& box) {
    return Box::load_unaligned(box.low);
}
HWY_INLINE void store_box(const Box& box, BuildBox& to) {
    box.store_unaligned(to.low);
}
/// The empty box.
HWY_INLINE Box empty_box() {
    return Box(-kHighest);
}
HWY_INLINE Box merge(const Box& a, const Box& b) {
    return max(a, b);
}
/// The negated minima.
HWY_INLINE Float4 low(const Box& box) {
    return lower_half(box);
}
/// The maxima.
HWY_INLINE Float4 high(const Box& box) {
    return upper_half(box);
}
/// The box of a single point: twice the centre.
HWY_INLINE Box centroid_box(const Box& box) {
    return box - swap_halves(box);
}

/// Extents along the axes.
HWY_INLINE Float4 extent(const Box& box) {
    return low(box) + high(box);
}

/// One axis of four things each.
struct ThreeAxes {
    Float4 x, y, z;
};

HWY_INLINE ThreeAxes transpose(Float4 a, Float4 b, Float4 c, Float4 d) {
    const Float4 ac_low = interleave_lower(a, c);
    const Float4 bd_low = interleave_lower(b, d);
    const Float4 ac_high = interleave_upper(a, c);
    const Float4 bd_high = interleave_upper(b, d);
    return {interleave_lower(ac_low, bd_low),
            interleave_upper(ac_low, bd_low),
            interleave_lower(ac_high, bd_high)};
}

/// Half areas of four boxes with these extents.
HWY_INLINE Float4 half_areas(const ThreeAxes& extents) {
    return (extents.x + extents.z) * extents.y + extents.z * extents.x;
}

/// Half the area of one box.
HWY_INLINE float half_area(const Box& box) {
    const Float4 e = extent(box);
    alignas(16) float areas[4];
    half_areas(transpose(e, e, e, e)).store(areas);
    return areas[0];
}

HWY_INLINE void store_node(const Box& box,
                           std::uint32_t first,
                           std::uint32_t count,
                           RawNode& node) {
    alignas(16) float lower[4], upper[4];
    (Float4(0.0F) - low(box)).store(lower);
    high(box).store(upper);
    for (std::size_t k = 0; k < 3; ++k) {
        node.lower[k] = lower[k];
        node.upper[k] = upper[k];
    }
    node.first = first;
    node.count = count;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
