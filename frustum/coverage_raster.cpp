// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/coverage_raster.h"

#include <algorithm>
#include <cmath>

namespace earshot::frustum {
namespace {

/// Floor into 0 ... cells - 1, whatever the value (NaN counts as 0).
int clamp_cell(double value, int cells) noexcept {
    if (!(value > 0.0)) {
        return 0;
    }
    return value >= cells ? cells - 1 : static_cast<int>(value);
}

/// The first whole number that is not below the value, clamped to 0 ... kGridSide.
int clamped_ceiling(double value) noexcept {
    constexpr int kShift = 16;  // makes positive, so that truncation rounds down
    const double clamped = std::clamp(value, -1.0, kGridSide + 1.0);
    return std::clamp(kShift - static_cast<int>(kShift - clamped), 0, kGridSide);
}

}  // namespace

CoverageRaster::CoverageRaster(const Rect& rect, int cells) noexcept
    : rect_(rect),
      cells_(cells),
      cell_size_((rect.upper - rect.lower) / static_cast<double>(cells)),
      scale_(static_cast<double>(cells) / (rect.upper - rect.lower)) {}

void CoverageRaster::start(double slack_in_cells, bool only_centres) noexcept {
    only_centres_ = only_centres;
    slack_ = slack_in_cells;
    boundary_ = 0;
    for (auto& row : winding_change_) {
        std::fill(std::begin(row), std::end(row), 0);
    }
}

void CoverageRaster::add_loop(std::span<const glm::dvec2> loop) noexcept {
    glm::dvec2 previous = (loop.back() - rect_.lower) * scale_;
    for (const glm::dvec2& point : loop) {
        const glm::dvec2 current = (point - rect_.lower) * scale_;
        if (!only_centres_) {
            mark_edge(previous, current);
        }
        wind_edge(previous, current);
        previous = current;
    }
}

// Marks every cell within slack of the edge. Row by row: the part of the edge inside the row
// (grown by slack) spans a range of columns.
void CoverageRaster::mark_edge(glm::dvec2 a, glm::dvec2 b) noexcept {
    if (a.y > b.y) {
        std::swap(a, b);
    }
    const double side = cells_;
    if (!(b.y >= -slack_) || !(a.y <= side + slack_) || !(std::max(a.x, b.x) >= -slack_) ||
        !(std::min(a.x, b.x) <= side + slack_)) {
        return;
    }
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    const int first_row = clamp_cell(a.y - slack_, cells_);
    const int last_row = clamp_cell(b.y + slack_, cells_);
    const double low_x = std::min(a.x, b.x);
    const double high_x = std::max(a.x, b.x);
    for (int row = first_row; row <= last_row; ++row) {
        double left = low_x;
        double right = high_x;
        if (b.y > a.y) {
            const double y0 = std::max(a.y, row - slack_);
            const double y1 = std::min(b.y, row + 1 + slack_);
            const double x0 = a.x + slope * (y0 - a.y);
            const double x1 = a.x + slope * (y1 - a.y);
            left = std::max(low_x, std::min(x0, x1));
            right = std::min(high_x, std::max(x0, x1));
        }
        // The interpolation above may be off by a few units in the last place of the coordinates,
        // which the callers' slack allows for (kCellSlack in visible_facets.h).
        left -= slack_;
        right += slack_;
        if (right < 0.0 || left > side) {
            continue;
        }
        boundary_ |= row_bits(row, clamp_cell(left, cells_), clamp_cell(right, cells_));
    }
}

// Counts the edge for every cell centre to the right of where it crosses the centre's row.
void CoverageRaster::wind_edge(glm::dvec2 a, glm::dvec2 b) noexcept {
    const int direction = a.y < b.y ? 1 : -1;
    if (direction < 0) {
        std::swap(a, b);
    }
    // Rows whose centre y lies in [a.y, b.y).
    const int first_row = clamped_ceiling(a.y - 0.5);
    const int end_row = std::min(cells_, clamped_ceiling(b.y - 0.5));
    if (first_row >= end_row) {
        return;
    }
    const double slope = (b.x - a.x) / (b.y - a.y);
    for (int row = first_row; row < end_row; ++row) {
        const double x = a.x + slope * (row + 0.5 - a.y);
        winding_change_[row][clamped_ceiling(x - 0.5)] += direction;
    }
}

Coverage CoverageRaster::finish() const noexcept {
    CellMask inside = 0;
    for (int row = 0; row < cells_; ++row) {
        std::int32_t winding = 0;
        for (int column = 0; column < cells_; ++column) {
            winding += winding_change_[row][column];
            inside |= static_cast<CellMask>(winding != 0) << (8 * row + column);
        }
    }
    // No edge passes a cell outside boundary_, so its centre decides for all of it.
    return {.outer = boundary_ | inside, .inner = inside & ~boundary_, .centre_sampled = inside};
}

CellMask CoverageRaster::cells_overlapping(const Rect& box, double slack_in_cells) const noexcept {
    const Range columns = range_of(box.lower.x, box.upper.x, 0, slack_in_cells);
    const Range rows = range_of(box.lower.y, box.upper.y, 1, slack_in_cells);
    if (columns.first > columns.last) {
        return 0;
    }
    CellMask mask = 0;
    for (int row = rows.first; row <= rows.last; ++row) {
        mask |= row_bits(row, columns.first, columns.last);
    }
    return mask;
}

CellMask CoverageRaster::cells_with_centre_in(const Rect& box) const noexcept {
    const glm::dvec2 low = (box.lower - rect_.lower) * scale_ - 0.5;
    const glm::dvec2 high = (box.upper - rect_.lower) * scale_ - 0.5;
    const int first_column = clamped_ceiling(low.x);
    const int first_row = clamped_ceiling(low.y);
    const int end_column = std::min(cells_, clamped_ceiling(std::nextafter(high.x, 1e300)));
    const int end_row = std::min(cells_, clamped_ceiling(std::nextafter(high.y, 1e300)));
    if (first_column >= end_column) {
        return 0;
    }
    CellMask mask = 0;
    for (int row = first_row; row < end_row; ++row) {
        mask |= row_bits(row, first_column, end_column - 1);
    }
    return mask;
}

CellMask CoverageRaster::cells_overlapping_grid(const CoverageRaster& other,
                                                CellMask cells,
                                                double slack_in_cells) const noexcept {
    CellMask columns_overlapping[kGridSide] = {};  // per column of this grid: columns of the other
    for (int column = 0; column < cells_; ++column) {
        const Rect rect = cell_rect(0, column);
        const Range columns = other.range_of(rect.lower.x, rect.upper.x, 0, slack_in_cells);
        if (columns.first <= columns.last) {
            columns_overlapping[column] = row_bits(0, columns.first, columns.last);
        }
    }
    CellMask mask = 0;
    for (int row = 0; row < cells_; ++row) {
        const Rect rect = cell_rect(row, 0);
        const Range rows = other.range_of(rect.lower.y, rect.upper.y, 1, slack_in_cells);
        CellMask columns = 0;
        for (int i = rows.first; i <= rows.last; ++i) {
            columns |= (cells >> (8 * i)) & 0xff;
        }
        for (int column = 0; column < cells_; ++column) {
            mask |= static_cast<CellMask>((columns & columns_overlapping[column]) != 0)
                    << (8 * row + column);
        }
    }
    return mask;
}

CoverageRaster::Range CoverageRaster::range_of(double lower,
                                               double upper,
                                               int axis,
                                               double slack_in_cells) const noexcept {
    const double from = (lower - rect_.lower[axis]) * scale_[axis] - slack_in_cells;
    const double to = (upper - rect_.lower[axis]) * scale_[axis] + slack_in_cells;
    if (!(to >= 0.0) || !(from <= cells_)) {
        return {};
    }
    return {.first = clamp_cell(from, cells_), .last = clamp_cell(to, cells_)};
}

Rect CoverageRaster::cell_rect(int row, int column) const noexcept {
    const glm::dvec2 lower = rect_.lower + glm::dvec2(column, row) * cell_size_;
    return {.lower = lower, .upper = lower + cell_size_};
}

}  // namespace earshot::frustum
