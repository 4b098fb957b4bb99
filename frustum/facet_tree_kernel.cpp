// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/facet_tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/facet_tree_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/word_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// The boxes of which no corner is in some half-space.
HWY_INLINE std::uint32_t bits_outside(const FrustumBoxTest& test,
                                      const double* sides,
                                      std::size_t first) {
    const auto farthest_corner = [&](std::size_t i) {
        const auto along = [&](std::size_t k) {
            return Doubles(test.normal[i][k]) * Doubles::load(sides + test.farthest[i][k] + first);
        };
        return along(0) + along(1) + along(2);
    };
    Doubles::Mask outside = farthest_corner(0) < Doubles(test.offset[0]);
    for (std::size_t i = 1; i < FrustumBoxTest::kHalfSpaces; ++i) {
        outside = outside | (farthest_corner(i) < Doubles(test.offset[i]));
    }
    return bits(outside);
}

/// The first and the last column (axis 0) or row of the grid that an interval of u or v overlaps.
struct CellRange {
    CellRange(const FrustumBoxTest& test,
              std::size_t axis,
              const Doubles& lower,
              const Doubles& upper,
              const Doubles& slack) {
        const Doubles scale(test.cells_per_unit[axis]), begin(test.grid_lower[axis]);
        const Doubles zero(0.0), side(test.grid_side), last_cell(test.grid_side - 1.0);
        const Doubles from = (lower - begin) * scale - slack;
        const Doubles to = (upper - begin) * scale + slack;
        overlaps = (zero <= to) & (from <= side);
        first = whole_part(min(max(zero, from), last_cell));
        last = whole_part(min(max(zero, to), last_cell));
    }

    Doubles::Mask overlaps;
    Words first, last;
};

/// Bit 8 * row + column of the cells in ranges of columns and rows.
HWY_INLINE Words cells_in(const CellRange& columns, const CellRange& rows) {
    const Words one(1), two(2), three(3), seven(7);
    Words row = (two << columns.last) - (one << columns.first);
    row = row | (row << Words(8));
    row = row | (row << Words(16));
    row = row | (row << Words(32));
    const Words in_rows = (two << ((rows.last << three) + seven)) - (one << (rows.first << three));
    return masked(columns.overlaps & rows.overlaps, row & in_rows);
}

HWY_INLINE void project(const FrustumBoxTest& test,
                        const FacetNode& node,
                        std::size_t first,
                        ChildBounds& projected) {
    const Doubles half(0.5);
    Doubles offset[3], extent[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const Doubles lower = Doubles::load(node.lower[k] + first);
        const Doubles upper = Doubles::load(node.upper[k] + first);
        offset[k] = half * (lower + upper) - Doubles(test.apex[k]);
        extent[k] = half * (upper - lower);
    }
    Doubles centre[3], reach[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        centre[axis] = offset[0] * Doubles(test.axes[axis][0]) +
                       offset[1] * Doubles(test.axes[axis][1]) +
                       offset[2] * Doubles(test.axes[axis][2]);
        reach[axis] = extent[0] * Doubles(test.abs_axes[axis][0]) +
                      extent[1] * Doubles(test.abs_axes[axis][1]) +
                      extent[2] * Doubles(test.abs_axes[axis][2]);
    }
    const Doubles min_depth = centre[2] - reach[2];
    centre[2].store(projected.centre_depth + first);
    min_depth.store(projected.min_depth + first);
    const Doubles one(1.0), zero(0.0);
    const Doubles near_scale = one / min_depth;
    const Doubles far_scale = one / (centre[2] + reach[2]);
    Doubles lower[2], upper[2];
    for (std::size_t k = 0; k < 2; ++k) {
        const Doubles low = centre[k] - reach[k];
        const Doubles high = centre[k] + reach[k];
        lower[k] = low * select(low < zero, near_scale, far_scale);
        upper[k] = high * select(high < zero, far_scale, near_scale);
        lower[k].store(projected.lower[k] + first);
        upper[k].store(projected.upper[k] + first);
    }
    const Doubles slack = Doubles(test.slack) + Doubles(test.slack_by_depth) * near_scale;
    cells_in({test, 0, lower[0], upper[0], slack}, {test, 1, lower[1], upper[1], slack})
        .store(projected.cells + first);
}

std::uint32_t project_children(const FrustumBoxTest& test,
                               const FacetNode& node,
                               ChildBounds& projected) {
    std::uint32_t inside = 0;
    for (std::size_t first = 0; first < FacetNode::kWidth; first += Doubles::kCount) {
        constexpr std::uint32_t kAll = (1U << Doubles::kCount) - 1;
        if ((node.used >> first & kAll) == 0) {
            continue;
        }
        const std::uint32_t here = ~bits_outside(test, node.lower[0], first) & kAll;
        if (here != 0) {
            project(test, node, first, projected);
        }
        inside |= here << first;
    }
    return inside & node.used;
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(project_children);

std::uint32_t project_boxes(const FrustumBoxTest& test,
                            const FacetNode& node,
                            ChildBounds& projected) noexcept {
    return HWY_DYNAMIC_DISPATCH(project_children)(test, node, projected);
}

}  // namespace earshot::frustum
#endif
