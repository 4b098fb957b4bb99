// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/raster_rows.h"

#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/coverage_raster_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/word_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// From its lower end to its upper one, in cells.
struct Edge {
    Edge(const RasterGrid& grid, const double* from, const double* to) {
        const auto in_cells = [&](const double* point, std::size_t k) {
            return (point[k] - grid.lower[k]) * grid.scale[k];
        };
        ax = in_cells(from, 0);
        ay = in_cells(from, 1);
        bx = in_cells(to, 0);
        by = in_cells(to, 1);
        goes_up = ay < by;
        if (ay > by) {
            std::swap(ax, bx);
            std::swap(ay, by);
        }
        slope = ay < by ? (bx - ax) / (by - ay) : 0.0;
    }

    double ax, ay, bx, by;
    double slope = 0.0;  ///< of x along y; 0 of a level edge
    bool goes_up = false;
};

/// Whether rows `first` to `first + kCount - 1` may lie within slack of the edge.
HWY_INLINE bool meets_rows(const Edge& edge, double slack, std::size_t first) {
    const auto begin = static_cast<double>(first);
    return edge.ay - slack <= begin + static_cast<double>(Doubles::kCount) &&
           edge.by + slack >= begin;
}

/// The columns in which the part of the edge in each row, grown by slack, lies: a bit for each.
HWY_INLINE Words columns_passed(const RasterGrid& grid, const Edge& edge, const Doubles& row) {
    const Doubles slack(grid.slack), zero(0.0), last_cell(grid.cells - 1.0);
    const double low_x = std::min(edge.ax, edge.bx);
    const double high_x = std::max(edge.ax, edge.bx);
    Doubles left(low_x), right(high_x);
    if (edge.ay < edge.by) {
        const Doubles ax(edge.ax), ay(edge.ay), slope(edge.slope);
        const Doubles x0 = ax + slope * (max(ay, row - slack) - ay);
        const Doubles x1 = ax + slope * (min(Doubles(edge.by), row + Doubles(1.0) + slack) - ay);
        left = max(left, min(x0, x1));
        right = min(right, max(x0, x1));
    }
    // The interpolation above may be off by a few units in the last place of the coordinates, which
    // the callers' slack allows for (kCellSlack in frustum.h).
    left = left - slack;
    right = right + slack;
    const Doubles lowest = min(Doubles(edge.ay) - slack, last_cell);
    const Doubles highest = max(Doubles(edge.by) + slack, zero);
    const Doubles::Mask passed = (lowest < row + Doubles(1.0)) & (row <= highest) &
                                 (row <= last_cell) & (zero <= right) &
                                 (left <= Doubles(grid.cells));
    const Words first = whole_part(min(max(zero, left), last_cell));
    const Words last = whole_part(min(max(zero, right), last_cell));
    return masked(passed, (Words(2) << last) - (Words(1) << first));
}

/// Per row whose centre the edge crosses: 1 in the byte of the first column whose centre lies to
/// the right of it.
HWY_INLINE Words crossings(const RasterGrid& grid, const Edge& edge, const Doubles& row) {
    const Doubles half(0.5), all(static_cast<double>(RasterRows::kCount));
    const Doubles ay(edge.ay);
    const Doubles x = Doubles(edge.ax) + Doubles(edge.slope) * (row + half - ay);
    const Doubles column = ceiling(min(max(Doubles(0.0), x - half), all));
    const Doubles::Mask crossed = (ay - half <= row) & (row < Doubles(edge.by) - half) &
                                  (row < Doubles(grid.cells)) & (column < all);
    const Words byte = whole_part(select(crossed, column, Doubles(0.0))) << Words(3);
    return masked(crossed, Words(1) << byte);
}

void add_edges_to(const RasterGrid& grid,
                  const double* vertices,
                  std::size_t size,
                  std::size_t first_edge,
                  std::size_t count,
                  bool only_centres,
                  RasterRows& rows) {
    alignas(64) static constexpr double kRows[RasterRows::kCount] = {0, 1, 2, 3, 4, 5, 6, 7};
    for (std::size_t i = first_edge; i < first_edge + count; ++i) {
        const std::size_t next = i + 1 < size ? i + 1 : 0;
        const Edge edge(grid, vertices + 2 * i, vertices + 2 * next);
        const double slack = grid.slack, side = grid.cells;
        if (!(edge.by >= -slack) || !(edge.ay <= side + slack)) {
            continue;
        }
        if (std::min(edge.ax, edge.bx) > side + slack) {
            continue;  // no centre lies to the right of it
        }
        const bool is_outside = only_centres || !(std::max(edge.ax, edge.bx) >= -slack) ||
                                !(std::min(edge.ax, edge.bx) <= side + slack);
        const Words up(edge.goes_up ? ~std::uint64_t{0} : 0);
        for (std::size_t first = 0; first < RasterRows::kCount; first += Doubles::kCount) {
            if (!meets_rows(edge, slack, first)) {
                continue;
            }
            const Doubles row = Doubles::load(kRows + first);
            if (!is_outside) {
                (Words::load(rows.boundary + first) | columns_passed(grid, edge, row))
                    .store(rows.boundary + first);
            }
            const Words crossed = crossings(grid, edge, row);
            (Words::load(rows.up + first) + (crossed & up)).store(rows.up + first);
            (Words::load(rows.down + first) + (crossed - (crossed & up))).store(rows.down + first);
        }
    }
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(add_edges_to);

void add_edges(const RasterGrid& grid,
               const double* vertices,
               std::size_t size,
               std::size_t first,
               std::size_t count,
               bool only_centres,
               RasterRows& rows) noexcept {
    HWY_DYNAMIC_DISPATCH(add_edges_to)(grid, vertices, size, first, count, only_centres, rows);
}

}  // namespace earshot::frustum
#endif
