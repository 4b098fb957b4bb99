// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/coverage_raster.h"

#include <algorithm>
#include <cmath>

namespace earshot::frustum {
namespace {

/// The first whole number that is not below the value, clamped to 0 ... kGridSide.
int clamped_ceiling(double value) noexcept {
    const double clamped = std::min(std::max(0.0, value), 1.0 * kGridSide);
    const int below = static_cast<int>(clamped);
    return below + static_cast<int>(clamped > below);
}

/// Bit k: whether byte k is not 0.
std::uint64_t bytes_set(std::uint64_t bytes) noexcept {
    constexpr std::uint64_t kLow7 = 0x7f7f7f7f7f7f7f7f;
    const std::uint64_t highest = (bytes | ((bytes & kLow7) + kLow7)) & ~kLow7;
    constexpr std::uint64_t kGather = 0x0102040810204080;  // bit 8 k to bit 56 + k
    return (highest >> 7) * kGather >> 56;
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
    rows_ = {};
    edges_ = 0;
    has_spilled_ = false;
}

// As many edges at a time as bytes can count.
void CoverageRaster::add_loop(std::span<const glm::dvec2> loop) noexcept {
    constexpr std::size_t kMaxEdges = 255;
    const RasterGrid grid = {.lower = {rect_.lower.x, rect_.lower.y},
                             .scale = {scale_.x, scale_.y},
                             .cells = 1.0 * cells_,
                             .slack = slack_};
    for (std::size_t first = 0; first < loop.size();) {
        if (edges_ == kMaxEdges) {
            spill_winding();
        }
        const std::size_t count = std::min(loop.size() - first, kMaxEdges - edges_);
        add_edges(grid, &loop.front().x, loop.size(), first, count, only_centres_, rows_);
        edges_ += count;
        first += count;
    }
}

void CoverageRaster::spill_winding() noexcept {
    for (int row = 0; row < kGridSide; ++row) {
        for (int column = 0; column < kGridSide; ++column) {
            const auto count_of = [&](std::uint64_t bytes) {
                return static_cast<std::int32_t>((bytes >> (8 * column)) & 0xff);
            };
            spilled_[row][column] = (has_spilled_ ? spilled_[row][column] : 0) +
                                    count_of(rows_.up[row]) - count_of(rows_.down[row]);
        }
        rows_.up[row] = rows_.down[row] = 0;
    }
    edges_ = 0;
    has_spilled_ = true;
}

Coverage CoverageRaster::finish() noexcept {
    CellMask inside = 0;
    if (has_spilled_) {
        spill_winding();
        for (int row = 0; row < cells_; ++row) {
            std::int32_t winding = 0;
            for (int column = 0; column < cells_; ++column) {
                winding += spilled_[row][column];
                inside |= static_cast<CellMask>(winding != 0) << (8 * row + column);
            }
        }
    } else {
        // Byte k of a product with ones is the sum of bytes 0 to k: how many edges go up or down
        // to the left. The winding number is the difference.
        constexpr std::uint64_t kOnes = 0x0101010101010101;
        const std::uint64_t columns = (std::uint64_t{1} << cells_) - 1;
        for (int row = 0; row < cells_; ++row) {
            if ((rows_.up[row] | rows_.down[row]) == 0) {
                continue;
            }
            const std::uint64_t differ = (rows_.up[row] * kOnes) ^ (rows_.down[row] * kOnes);
            inside |= (bytes_set(differ) & columns) << (8 * row);
        }
    }
    // No edge passes a cell outside the boundary, so its centre decides for all of it.
    CellMask boundary = 0;
    for (int row = 0; row < cells_; ++row) {
        boundary |= rows_.boundary[row] << (8 * row);
    }
    return {.outer = boundary | inside, .inner = inside & ~boundary, .centre_sampled = inside};
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

Rect CoverageRaster::cell_rect(int row, int column) const noexcept {
    const glm::dvec2 lower = rect_.lower + glm::dvec2(column, row) * cell_size_;
    return {.lower = lower, .upper = lower + cell_size_};
}

}  // namespace earshot::frustum
