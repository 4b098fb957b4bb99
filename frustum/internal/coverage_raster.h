// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/raster_rows.h"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::frustum {

/// One bit per sub-frustum of an 8 x 8 grid; bit 8 * row + column.
using CellMask = std::uint64_t;

inline constexpr int kGridSide = 8;
inline constexpr CellMask kAllCells = ~CellMask{0};

/// An axis-aligned rectangle in a frustum's (u, v) plane.
struct Rect {
    glm::dvec2 lower{0.0};
    glm::dvec2 upper{0.0};
    friend bool operator==(const Rect&, const Rect&) = default;
};

/// Bits first ... last (inclusive, within 0..7) of one row.
constexpr CellMask row_bits(int row, int first, int last) noexcept {
    const CellMask bits = (CellMask{0xff} >> (7 - (last - first))) << first;
    return bits << (8 * row);
}

/// Which cells of a grid a polygon covers, in three senses.
struct Coverage {
    CellMask outer = 0;  ///< outer-conservative: superset of the cells that the polygon touches
    CellMask inner = 0;  ///< inner-conservative: subset of the cells that lie inside the polygon
    CellMask centre_sampled = 0;  ///< cells whose centre lies inside, without slack
};

/// Rasterises closed polygons into a grid of n x n cells (n <= 8) over a rectangle, conservatively:
/// positions may be off by `slack` (in cells) without a cell going missing from `outer` or
/// appearing in `inner`. Loops are combined under the non-zero winding rule, so holes and
/// overlapping parts count as they should.
class CoverageRaster {
public:
    CoverageRaster(const Rect& rect, int cells) noexcept;

    /// Begins a new polygon. `only_centres`: only Coverage::centre_sampled is needed; the other
    /// masks then equal it.
    void start(double slack_in_cells, bool only_centres = false) noexcept;
    /// Adds a closed loop; points in (u, v).
    void add_loop(std::span<const glm::dvec2> loop) noexcept;
    Coverage finish() noexcept;

    /// The cells that a box of (u, v), grown by slack_in_cells, overlaps.
    CellMask cells_overlapping(const Rect& box, double slack_in_cells) const noexcept {
        const Range columns = range_of(box.lower.x, box.upper.x, 0, slack_in_cells);
        const Range rows = range_of(box.lower.y, box.upper.y, 1, slack_in_cells);
        if (columns.first > columns.last || rows.first > rows.last) {
            return 0;
        }
        constexpr CellMask kFirstColumn = 0x0101010101010101;
        return row_bits(0, columns.first, columns.last) * kFirstColumn & row_range(rows);
    }

    /// The cells whose centres lie in a box of (u, v), as computed without slack.
    CellMask cells_with_centre_in(const Rect& box) const noexcept;

    /// The cells that overlap, grown by slack_in_cells (of the other grid), one of `cells` of
    /// another grid over the same (u, v).
    CellMask cells_overlapping_grid(const CoverageRaster& other,
                                    CellMask cells,
                                    double slack_in_cells) const noexcept;

    int cells() const noexcept { return cells_; }
    glm::dvec2 cell_size() const noexcept { return cell_size_; }
    Rect cell_rect(int row, int column) const noexcept;

private:
    struct Range {
        int first = 0, last = -1;  // empty if last < first
    };

    /// Floor into 0 ... cells - 1, whatever the value (NaN counts as 0).
    static int clamp_cell(double value, int cells) noexcept {
        return static_cast<int>(std::min(std::max(0.0, value), cells - 1.0));
    }
    Range range_of(double lower, double upper, int axis, double slack_in_cells) const noexcept {
        const double from = (lower - rect_.lower[axis]) * scale_[axis] - slack_in_cells;
        const double to = (upper - rect_.lower[axis]) * scale_[axis] + slack_in_cells;
        if (!(to >= 0.0) || !(from <= cells_)) {
            return {};
        }
        return {.first = clamp_cell(from, cells_), .last = clamp_cell(to, cells_)};
    }
    void spill_winding() noexcept;
    static CellMask row_range(const Range& rows) noexcept {
        return (kAllCells >> (kGridSide * (kGridSide - 1 - rows.last))) &
               (kAllCells << (kGridSide * rows.first));
    }

    Rect rect_;
    int cells_;
    glm::dvec2 cell_size_;
    glm::dvec2 scale_;
    double slack_ = 0.0;
    bool only_centres_ = false;
    // Winding numbers of edges beyond those that bytes can count are in `spilled_`.
    RasterRows rows_;
    std::size_t edges_ = 0;
    bool has_spilled_ = false;
    std::int32_t spilled_[kGridSide][kGridSide];
};

}  // namespace earshot::frustum
