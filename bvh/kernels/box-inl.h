// SPDX-License-Identifier: MIT
//
// Boxes in registers, for kernels that are compiled once per instruction set; see base/wide.h for
// how such a file is included, and why this header has a guard per target.

#include "earshot/bvh/internal/build_box.h"
#include "earshot/bvh/kernels/quad-inl.h"

#include <limits>

#if defined(EARSHOT_BVH_KERNELS_BOX_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_BOX_INL_H
#undef EARSHOT_BVH_KERNELS_BOX_INL_H
#else
#define EARSHOT_BVH_KERNELS_BOX_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// The largest float.
constexpr float kHighest = std::numeric_limits<float>::max();

/// A BuildBox in one register, or in two where registers hold four floats.
#if HWY_MAX_BYTES >= 32
using BoxTag = hn::FixedTag<float, 8>;
using Box = hn::Vec<BoxTag>;
using Choice = hn::Mask<BoxTag>;

HWY_INLINE Box load_box(const BuildBox& box) {
    return hn::LoadU(BoxTag(), box.low);
}
HWY_INLINE void store_box(Box box, BuildBox& to) {
    hn::StoreU(box, BoxTag(), to.low);
}
HWY_INLINE Box nothing() {
    return hn::Set(BoxTag(), -kHighest);
}
HWY_INLINE Box join(Box a, Box b) {
    return hn::Max(a, b);
}
HWY_INLINE Quad low(Box box) {
    return hn::LowerHalf(QuadTag(), box);
}
HWY_INLINE Quad high(Box box) {
    return hn::UpperHalf(QuadTag(), box);
}
/// The box of a single point: twice the centre.
HWY_INLINE Box centre_box(Box box) {
    return hn::Sub(box, hn::ReverseBlocks(BoxTag(), box));
}
/// All lanes if value < bound, else none.
HWY_INLINE Choice choose_if_less(float value, float bound) {
    return hn::Lt(hn::Set(BoxTag(), value), hn::Set(BoxTag(), bound));
}
/// The first box if chosen, else the second.
HWY_INLINE Box select(Choice choice, Box yes, Box no) {
    return hn::IfThenElse(choice, yes, no);
}
#else
struct Box {
    Quad low, high;
};
using Choice = QuadMask;

HWY_INLINE Box load_box(const BuildBox& box) {
    return {load_quad(box.low), load_quad(box.high)};
}
HWY_INLINE void store_box(Box box, BuildBox& to) {
    store_quad(box.low, to.low);
    store_quad(box.high, to.high);
}
HWY_INLINE Box nothing() {
    return {all_four(-kHighest), all_four(-kHighest)};
}
HWY_INLINE Box join(Box a, Box b) {
    return {larger(a.low, b.low), larger(a.high, b.high)};
}
HWY_INLINE Quad low(Box box) {
    return box.low;
}
HWY_INLINE Quad high(Box box) {
    return box.high;
}
/// The box of a single point: twice the centre.
HWY_INLINE Box centre_box(Box box) {
    return {subtract(box.low, box.high), subtract(box.high, box.low)};
}
/// All lanes if value < bound, else none.
HWY_INLINE Choice choose_if_less(float value, float bound) {
    return less(all_four(value), all_four(bound));
}
/// The first box if chosen, else the second.
HWY_INLINE Box select(Choice choice, Box yes, Box no) {
    return {select(choice, yes.low, no.low), select(choice, yes.high, no.high)};
}
#endif

/// Extents along the axes.
HWY_INLINE Quad extent(Box box) {
    return add(low(box), high(box));
}

/// One axis of four things each.
struct ThreeQuads {
    Quad x, y, z;
};

HWY_INLINE ThreeQuads transpose(Quad a, Quad b, Quad c, Quad d) {
    const Quad ac_low = interleave_lower(a, c);
    const Quad bd_low = interleave_lower(b, d);
    const Quad ac_high = interleave_upper(a, c);
    const Quad bd_high = interleave_upper(b, d);
    return {interleave_lower(ac_low, bd_low),
            interleave_upper(ac_low, bd_low),
            interleave_lower(ac_high, bd_high)};
}

/// Half areas of four boxes with these extents.
HWY_INLINE Quad half_areas(const ThreeQuads& extents) {
    return add(multiply(add(extents.x, extents.z), extents.y), multiply(extents.z, extents.x));
}

/// Half the area of one box.
HWY_INLINE float half_area(Box box) {
    const Quad e = extent(box);
    alignas(16) float areas[4];
    store_quad(half_areas(transpose(e, e, e, e)), areas);
    return areas[0];
}

HWY_INLINE void store_node(Box box, std::uint32_t first, std::uint32_t count, RawNode& node) {
    alignas(16) float lower[4], upper[4];
    store_quad(subtract(all_four(0.0F), low(box)), lower);
    store_quad(high(box), upper);
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
