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

/// ConnectingLegs in every lane, and where their boxes' sides lie in memory.
struct WideLegs {
    explicit WideLegs(const ConnectingLegs& legs)
        : narrow(legs),
          lower_u(legs.lower[0]),
          lower_v(legs.lower[1]),
          upper_u(legs.upper[0]),
          upper_v(legs.upper[1]),
          min_depth(legs.min_depth),
          max_length(legs.max_length),
          sign(legs.sign) {
        for (int i = 0; i < legs.half_space_count; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                farthest[i][k] = row(k, legs.half_spaces[i].normal[k] > 0.0F);
            }
        }
        if (legs.axis >= 0) {
            const bool is_forward = legs.sign > 0.0F;
            const auto axis = static_cast<std::size_t>(legs.axis);
            depth_rows[0] = row(axis, !is_forward);
            depth_rows[1] = row(axis, is_forward);
            near_apex = sign * Float8(is_forward ? legs.high_apex[axis] : legs.low_apex[axis]);
            far_apex = sign * Float8(is_forward ? legs.low_apex[axis] : legs.high_apex[axis]);
            u = (axis + 1) % 3;
            v = (axis + 2) % 3;
        }
    }

    /// Of the lower or upper sides along an axis in a box of a block.
    static std::size_t row(std::size_t axis, bool is_upper) {
        return SubpathBlock::kWidth * (is_upper ? 3 + axis : axis);
    }

    const ConnectingLegs& narrow;
    Float8 lower_u, lower_v, upper_u, upper_v;
    Float8 min_depth, max_length;
    Float8 sign, near_apex, far_apex;
    std::size_t farthest[5][3];  // sides along the normals of half-spaces
    std::size_t depth_rows[2];   // near and far sides along the axis
    std::size_t u = 0, v = 0;    // the axes across
};

/// Eight boxes projected from the apex along an axis: bounds of quotients and of the depth.
struct ProjectedBoxes {
    Float8 lower_u, upper_u, lower_v, upper_v;
    Float8 min_depth, max_depth;
};

HWY_INLINE ProjectedBoxes projected(const WideLegs& legs, const SubpathBlock::Box& box) {
    const float* sides = box.lower[0];
    ProjectedBoxes result;
    result.min_depth = legs.sign * Float8::load(sides + legs.depth_rows[0]) - legs.near_apex;
    result.max_depth = legs.sign * Float8::load(sides + legs.depth_rows[1]) - legs.far_apex;
    // A box that reaches the apex's depth has points in front of it at any small depth.
    const Float8 tiny(0x1p-100F);
    const Float8 near_scale = Float8(1.0F) / max(result.min_depth, tiny);
    const Float8 far_scale = Float8(1.0F) / max(result.max_depth, tiny);
    const Float8 low_u = Float8::load(box.lower[legs.u]) - Float8(legs.narrow.high_apex[legs.u]);
    const Float8 high_u = Float8::load(box.upper[legs.u]) - Float8(legs.narrow.low_apex[legs.u]);
    const Float8 low_v = Float8::load(box.lower[legs.v]) - Float8(legs.narrow.high_apex[legs.v]);
    const Float8 high_v = Float8::load(box.upper[legs.v]) - Float8(legs.narrow.low_apex[legs.v]);
    result.lower_u = min(low_u * near_scale, low_u * far_scale);
    result.upper_u = max(high_u * near_scale, high_u * far_scale);
    result.lower_v = min(low_v * near_scale, low_v * far_scale);
    result.upper_v = max(high_v * near_scale, high_v * far_scale);
    return result;
}

/// The boxes of which no corner is in some half-space.
HWY_INLINE Float8::Mask lie_outside(const WideLegs& legs, const SubpathBlock::Box& box, int i) {
    const float* sides = box.lower[0];
    const ConnectingLegs::HalfSpace& half_space = legs.narrow.half_spaces[i];
    const std::size_t* rows = legs.farthest[i];
    return Float8(half_space.normal[0]) * Float8::load(sides + rows[0]) +
               Float8(half_space.normal[1]) * Float8::load(sides + rows[1]) +
               Float8(half_space.normal[2]) * Float8::load(sides + rows[2]) <
           Float8(half_space.offset);
}
HWY_INLINE std::uint32_t bits_outside(const WideLegs& legs, const SubpathBlock::Box& box) {
    Float8::Mask outside = lie_outside(legs, box, 0);
    for (int i = 1; i < legs.narrow.half_space_count; ++i) {
        outside = outside | lie_outside(legs, box, i);
    }
    return bits(outside);
}

/// Bits of the subpaths or nodes that a leg may connect: a direction from the apex passes the
/// frustum's aperture, the aperture of the subpath and, not closer, the image.
template <bool kIsProjected>
HWY_INLINE std::uint32_t bits_connected(const WideLegs& legs, const SubpathBlock& block) {
    constexpr std::uint32_t kAll = 0xffU;
    if constexpr (!kIsProjected) {
        const std::uint32_t beside = bits_outside(legs, block.aperture);
        return beside == kAll ? 0 : ~(beside | bits_outside(legs, block.image)) & kAll;
    } else {
        const ProjectedBoxes aperture = projected(legs, block.aperture);
        const Float8 lower_u = max(aperture.lower_u, legs.lower_u);
        const Float8 upper_u = min(aperture.upper_u, legs.upper_u);
        const Float8 lower_v = max(aperture.lower_v, legs.lower_v);
        const Float8 upper_v = min(aperture.upper_v, legs.upper_v);
        const std::uint32_t beside = bits((aperture.max_depth < legs.min_depth) |
                                          (upper_u < lower_u) | (upper_v < lower_v)) |
                                     bits_outside(legs, block.aperture);
        if (beside == kAll) {
            return 0;
        }
        const ProjectedBoxes image = projected(legs, block.image);
        const Float8::Mask outside = (image.max_depth < max(aperture.min_depth, legs.min_depth)) |
                                     (legs.max_length < image.min_depth) |
                                     (image.upper_u < lower_u) | (upper_u < image.lower_u) |
                                     (image.upper_v < lower_v) | (upper_v < image.lower_v);
        return ~(beside | bits(outside) | bits_outside(legs, block.image)) & kAll;
    }
}

template <bool kIsProjected>
void visit_connected(const SubpathTree& tree,
                     const WideLegs& legs,
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
        std::uint32_t bits =
            bits_connected<kIsProjected>(legs, tree.blocks()[nodes.first_block + block]);
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

void find_connected(const SubpathTree& tree,
                    const ConnectingLegs& narrow,
                    std::vector<std::uint32_t>& found) {
    const WideLegs legs(narrow);
    if (narrow.axis >= 0) {
        visit_connected<true>(tree, legs, found);
    } else {
        visit_connected<false>(tree, legs, found);
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
