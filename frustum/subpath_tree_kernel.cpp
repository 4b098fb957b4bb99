// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_tree.h"

#include <array>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/subpath_tree_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// A vector for eight boxes. Members have names, as the compiler keeps no array in registers here.
struct Triple {
    Float8 x, y, z;
};

HWY_INLINE Triple repeated(const float (&vector)[3]) {
    return {Float8(vector[0]), Float8(vector[1]), Float8(vector[2])};
}
HWY_INLINE Float8 dot(const Triple& a, const Triple& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Triple abs_of(const Triple& a) {
    return {abs(a.x), abs(a.y), abs(a.z)};
}

/// ConnectingLegs in every lane.
struct WideLegs {
    explicit WideLegs(const ConnectingLegs& legs)
        : apex(repeated(legs.apex)),
          right(repeated(legs.axes[0])),
          up(repeated(legs.axes[1])),
          forward(repeated(legs.axes[2])),
          normal(repeated(legs.normal)),
          height(Float8(legs.normal[0] * legs.apex[0] + legs.normal[1] * legs.apex[1] +
                        legs.normal[2] * legs.apex[2] - legs.offset)),
          lower_u(legs.lower[0]),
          lower_v(legs.lower[1]),
          upper_u(legs.upper[0]),
          upper_v(legs.upper[1]),
          margin(legs.margin),
          min_depth(legs.min_depth),
          max_length(legs.max_length) {}

    Triple apex, right, up, forward, normal;
    Float8 height;  // of the apex above the plane
    Float8 lower_u, lower_v, upper_u, upper_v;
    Float8 margin, min_depth, max_length;
};

/// Eight boxes in the axes of a frustum: bounds of (u, v) and of the depth.
struct LocalBoxes {
    Float8 lower_u, upper_u, lower_v, upper_v;
    Float8 min_depth, max_depth;
    Float8::Mask is_behind;  // the plane of the frustum's start
};

HWY_INLINE Float8 quotient(Float8 value, Float8 if_negative, Float8 if_positive) {
    return value * select(value < Float8(0.0F), if_negative, if_positive);
}

HWY_INLINE LocalBoxes local_boxes(const WideLegs& legs, const SubpathBlock::Box& box) {
    const Float8 one_half(0.5F);
    const Triple low = {
        Float8::load(box.lower[0]), Float8::load(box.lower[1]), Float8::load(box.lower[2])};
    const Triple high = {
        Float8::load(box.upper[0]), Float8::load(box.upper[1]), Float8::load(box.upper[2])};
    const Triple centre = {one_half * (low.x + high.x) - legs.apex.x,
                           one_half * (low.y + high.y) - legs.apex.y,
                           one_half * (low.z + high.z) - legs.apex.z};
    const Triple half = {
        one_half * (high.x - low.x), one_half * (high.y - low.y), one_half * (high.z - low.z)};
    const Float8 u = dot(legs.right, centre);
    const Float8 v = dot(legs.up, centre);
    const Float8 depth = dot(legs.forward, centre);
    const Float8 size_u = dot(abs_of(legs.right), half) + legs.margin;
    const Float8 size_v = dot(abs_of(legs.up), half) + legs.margin;
    const Float8 size = dot(abs_of(legs.forward), half) + legs.margin;
    LocalBoxes result;
    result.is_behind =
        legs.height + dot(legs.normal, centre) + (dot(abs_of(legs.normal), half) + legs.margin) <
        Float8(0.0F);
    result.min_depth = depth - size;
    result.max_depth = depth + size;
    // A box that reaches the apex's depth has points in front of it at any small depth.
    const Float8 tiny(0x1p-100F);
    const Float8 near_scale = Float8(1.0F) / max(result.min_depth, tiny);
    const Float8 far_scale = Float8(1.0F) / max(result.max_depth, tiny);
    result.lower_u = quotient(u - size_u, near_scale, far_scale);
    result.upper_u = quotient(u + size_u, far_scale, near_scale);
    result.lower_v = quotient(v - size_v, near_scale, far_scale);
    result.upper_v = quotient(v + size_v, far_scale, near_scale);
    return result;
}

/// Bits of the subpaths or nodes that a leg may connect: a direction from the apex passes the
/// frustum's aperture, the aperture of the subpath and, not closer, the image.
HWY_INLINE std::uint32_t bits_connected(const WideLegs& legs, const SubpathBlock& block) {
    const Float8 rounding(0x1p-20F);
    const LocalBoxes aperture = local_boxes(legs, block.aperture);
    const Float8 lower_u = max(aperture.lower_u, legs.lower_u);
    const Float8 upper_u = min(aperture.upper_u, legs.upper_u) + rounding;
    const Float8 lower_v = max(aperture.lower_v, legs.lower_v);
    const Float8 upper_v = min(aperture.upper_v, legs.upper_v) + rounding;
    const Float8::Mask beside = aperture.is_behind | (aperture.max_depth < legs.min_depth) |
                                (upper_u < lower_u) | (upper_v < lower_v);
    if (bits(beside) == 0xffU) {
        return 0;
    }
    const LocalBoxes image = local_boxes(legs, block.image);
    const Float8::Mask outside = beside | image.is_behind |
                                 (image.max_depth < max(aperture.min_depth, legs.min_depth)) |
                                 (legs.max_length < image.min_depth) |
                                 (image.upper_u + rounding < lower_u) | (upper_u < image.lower_u) |
                                 (image.upper_v + rounding < lower_v) | (upper_v < image.lower_v);
    return ~bits(outside) & 0xffU;
}

void find_connected(const SubpathTree& tree,
                    const ConnectingLegs& narrow,
                    std::vector<std::uint32_t>& found) {
    const WideLegs legs(narrow);
    constexpr std::size_t kWidth = SubpathBlock::kWidth;
    constexpr std::size_t kMaxLevels = 12;
    struct Entry {
        std::size_t level, block;
    };
    std::array<Entry, kMaxLevels * kWidth> stack;
    std::size_t size = 0;
    stack[size++] = {tree.levels().size() - 1, 0};
    while (size > 0) {
        const auto [level, block] = stack[--size];
        const SubpathTree::Level& nodes = tree.levels()[level];
        std::uint32_t bits = bits_connected(legs, tree.blocks()[nodes.first_block + block]);
        const std::size_t first = kWidth * block;
        if (nodes.count - first < kWidth) {
            bits &= (1U << (nodes.count - first)) - 1;
        }
        for (; bits != 0; bits &= bits - 1) {
            const std::size_t node = first + static_cast<std::size_t>(std::countr_zero(bits));
            if (level == 0) {
                found.push_back(tree.numbers()[node]);
            } else {
                stack[size++] = {level - 1, node};
            }
        }
    }
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(find_connected);

void SubpathTree::find(const ConnectingLegs& legs, std::vector<std::uint32_t>& found) const {
    if (!levels_.empty()) {
        HWY_DYNAMIC_DISPATCH(find_connected)(*this, legs, found);
    }
}

}  // namespace earshot::frustum
#endif
