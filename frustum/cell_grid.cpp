// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/cell_grid.h"

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

}  // namespace

CellRaster::CellRaster(const Rect& rect, int cells) noexcept
    : rect_(rect),
      cells_(cells),
      cell_size_((rect.upper - rect.lower) / static_cast<double>(cells)),
      scale_(static_cast<double>(cells) / (rect.upper - rect.lower)) {}

void CellRaster::start(double slack_in_cells) noexcept {
    slack_ = slack_in_cells;
    edge_ = 0;
    for (auto& row : winding_) {
        std::fill(std::begin(row), std::end(row), 0);
    }
}

void CellRaster::add_loop(std::span<const glm::dvec2> loop) noexcept {
    glm::dvec2 previous = (loop.back() - rect_.lower) * scale_;
    for (const glm::dvec2& point : loop) {
        const glm::dvec2 current = (point - rect_.lower) * scale_;
        mark_edge(previous, current);
        wind_edge(previous, current);
        previous = current;
    }
}

// Marks every cell within slack of the edge. Row by row: the part of the edge inside the row
// (grown by slack) spans a range of columns.
void CellRaster::mark_edge(glm::dvec2 a, glm::dvec2 b) noexcept {
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
        // which the callers' slack has room for (see project() in visible_facets.cpp).
        left -= slack_;
        right += slack_;
        if (right < 0.0 || left > side) {
            continue;
        }
        edge_ |= row_bits(row, clamp_cell(left, cells_), clamp_cell(right, cells_));
    }
}

// Counts the edge for every cell centre to the right of where it crosses the centre's row.
void CellRaster::wind_edge(glm::dvec2 a, glm::dvec2 b) noexcept {
    const int direction = a.y < b.y ? 1 : -1;
    if (direction < 0) {
        std::swap(a, b);
    }
    // Rows whose centre y lies in [a.y, b.y).
    const int first_row = static_cast<int>(std::clamp(std::ceil(a.y - 0.5), 0.0, 8.0));
    const int end_row =
        std::min(cells_, static_cast<int>(std::clamp(std::ceil(b.y - 0.5), 0.0, 8.0)));
    if (first_row >= end_row) {
        return;
    }
    const double slope = (b.x - a.x) / (b.y - a.y);
    for (int row = first_row; row < end_row; ++row) {
        const double x = a.x + slope * (row + 0.5 - a.y);
        const int first = static_cast<int>(std::clamp(std::ceil(x - 0.5), 0.0, 8.0));
        for (int column = first; column < kGridSide; ++column) {
            winding_[row][column] += direction;
        }
    }
}

Coverage CellRaster::finish() const noexcept {
    CellMask inside = 0;
    for (int row = 0; row < cells_; ++row) {
        for (int column = 0; column < cells_; ++column) {
            inside |= static_cast<CellMask>(winding_[row][column] != 0) << (8 * row + column);
        }
    }
    // No edge passes a cell outside edge_, so its centre speaks for all of it.
    return {.touched = edge_ | inside, .filled = inside & ~edge_, .centred = inside};
}

CellMask CellRaster::cells_of(const Rect& box, double slack_in_cells) const noexcept {
    const glm::dvec2 lower = (box.lower - rect_.lower) * scale_ - slack_in_cells;
    const glm::dvec2 upper = (box.upper - rect_.lower) * scale_ + slack_in_cells;
    const double side = cells_;
    if (!(upper.x >= 0.0) || !(upper.y >= 0.0) || !(lower.x <= side) || !(lower.y <= side)) {
        return 0;
    }
    const int first = clamp_cell(lower.x, cells_);
    const int last = clamp_cell(upper.x, cells_);
    CellMask mask = 0;
    for (int row = clamp_cell(lower.y, cells_); row <= clamp_cell(upper.y, cells_); ++row) {
        mask |= row_bits(row, first, last);
    }
    return mask;
}

Rect CellRaster::cell_rect(int row, int column) const noexcept {
    const glm::dvec2 lower = rect_.lower + glm::dvec2(column, row) * cell_size_;
    return {.lower = lower, .upper = lower + cell_size_};
}

}  // namespace earshot::frustum
