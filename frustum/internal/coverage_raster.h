// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

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
    Coverage finish() const noexcept;

    /// The cells that a box of (u, v), grown by slack_in_cells, overlaps.
    CellMask cells_overlapping(const Rect& box, double slack_in_cells) const noexcept;

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

    Range range_of(double lower, double upper, int axis, double slack_in_cells) const noexcept;
    void mark_edge(glm::dvec2 a, glm::dvec2 b) noexcept;
    void wind_edge(glm::dvec2 a, glm::dvec2 b) noexcept;

    Rect rect_;
    int cells_;
    glm::dvec2 cell_size_;
    glm::dvec2 scale_;
    double slack_ = 0.0;
    bool only_centres_ = false;
    CellMask boundary_ = 0;
    // Change of the winding number from the column before; one past the last is never read.
    std::int32_t winding_change_[kGridSide][kGridSide + 1] = {};
};

/// Bits first ... last (inclusive, within 0..7) of one row.
constexpr CellMask row_bits(int row, int first, int last) noexcept {
    const CellMask bits = (CellMask{0xff} >> (7 - (last - first))) << first;
    return bits << (8 * row);
}

}  // namespace earshot::frustum
