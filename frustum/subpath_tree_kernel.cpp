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

/// Eight boxes in the axes of a frustum: bounds of (u, v) and of the depth.
struct LocalBoxes {
    Float8 lower[2], upper[2];
    Float8 min_depth, max_depth;
    Float8::Mask is_behind;  // the plane of the frustum's start
};

HWY_INLINE LocalBoxes local_boxes(const ConnectingLegs& legs, const SubpathBlock::Box& box) {
    Float8 centre[3], half[3];
    const Float8 margin(legs.margin);
    Float8 height = Float8(-legs.offset);
    Float8 reach = margin;
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 low = Float8::load(box.lower[k]);
        const Float8 high = Float8::load(box.upper[k]);
        centre[k] = Float8(0.5F) * (low + high);
        half[k] = Float8(0.5F) * (high - low);
        height = height + Float8(legs.normal[k]) * centre[k];
        reach = reach + abs(Float8(legs.normal[k])) * half[k];
        centre[k] = centre[k] - Float8(legs.apex[k]);
    }
    Float8 local[3], extent[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        local[axis] = Float8(0.0F);
        extent[axis] = margin;
        for (std::size_t k = 0; k < 3; ++k) {
            const Float8 component(legs.axes[axis][k]);
            local[axis] = local[axis] + component * centre[k];
            extent[axis] = extent[axis] + abs(component) * half[k];
        }
    }
    LocalBoxes result;
    result.is_behind = height < -reach;
    result.min_depth = local[2] - extent[2];
    result.max_depth = local[2] + extent[2];
    // Of a box that reaches the apex's depth, any direction.
    const Float8::Mask is_bounded = Float8(0x1p-100F) < result.min_depth;
    const Float8 far(0x1p100F);
    const Float8 near_scale = Float8(1.0F) / result.min_depth;
    const Float8 far_scale = Float8(1.0F) / result.max_depth;
    for (std::size_t k = 0; k < 2; ++k) {
        const Float8 low = local[k] - extent[k];
        const Float8 high = local[k] + extent[k];
        const Float8 lower = low * select(low < Float8(0.0F), near_scale, far_scale);
        const Float8 upper = high * select(high < Float8(0.0F), far_scale, near_scale);
        result.lower[k] = select(is_bounded, lower, -far);
        result.upper[k] = select(is_bounded, upper, far);
    }
    return result;
}

/// Bits of the subpaths or nodes that a leg may connect: a direction from the apex passes the
/// frustum's aperture, the aperture of the subpath and, not closer, the image.
HWY_INLINE std::uint32_t bits_connected(const ConnectingLegs& legs, const SubpathBlock& block) {
    const LocalBoxes aperture = local_boxes(legs, block.aperture);
    const LocalBoxes image = local_boxes(legs, block.image);
    const Float8 rounding(0x1p-20F);
    Float8::Mask outside = aperture.is_behind | image.is_behind |
                           (aperture.max_depth < Float8(legs.min_depth)) |
                           (image.max_depth < max(aperture.min_depth, Float8(legs.min_depth))) |
                           (Float8(legs.max_length) < image.min_depth);
    for (std::size_t k = 0; k < 2; ++k) {
        const Float8 lower = max(max(aperture.lower[k], image.lower[k]), Float8(legs.lower[k]));
        const Float8 upper = min(min(aperture.upper[k], image.upper[k]), Float8(legs.upper[k]));
        outside = outside | (upper + rounding < lower);
    }
    return ~bits(outside) & 0xffU;
}

void find_connected(const SubpathTree& tree,
                    const ConnectingLegs& legs,
                    std::vector<std::uint32_t>& found) {
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
