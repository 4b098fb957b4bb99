// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/coverage_raster.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/occlusion_rows.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace earshot::frustum {

/// Per sub-frustum how deep its occluder lies at most, in few bits: as a bound from below of the
/// inverse depth, the upper half of a float; 0: without an occluder.
struct OccluderDepths {
    std::array<std::uint16_t, 64> inverse{};

    /// Whether all of `cells` have an occluder that is closer than a depth in metres.
    bool hide(double depth, CellMask cells) const noexcept;
};

/// A coarse depth buffer over the sub-frusta of a frustum: per cell the closest known plane that
/// occludes everything behind it. In complete mode a facet occludes the cells that it covers wholly
/// (Coverage::inner); in sampled mode, those whose centre it covers.
class OcclusionGrid {
public:
    /// Forgets all occluders. `first_centre`: of cell 0, in (u, v).
    void reset(const glm::dvec2& first_centre, const glm::dvec2& cell_size) noexcept;

    /// Enters a plane of a facet into those of `cells` where it is closer at the centre than the
    /// occluder so far. `depth`: of the plane, already scaled down by its error.
    void add(geometry::FacetId facet, const InverseDepth& depth, CellMask cells) noexcept;

    /// Cells that have an occluder.
    CellMask occluded() const noexcept { return occluded_; }

    /// Those of `cells` whose occluder belongs to the facet.
    CellMask cells_occluded_by(geometry::FacetId facet, CellMask cells) const noexcept;

    /// Those of `cells` in which plane a is closer than plane b everywhere, by more than rounding.
    CellMask cells_where_closer(const InverseDepth& a,
                                const InverseDepth& b,
                                CellMask cells) const noexcept;

    /// Those of `cells` whose occluder, of another facet, is closer than the plane everywhere.
    CellMask cells_occluding(geometry::FacetId facet,
                             const InverseDepth& depth,
                             CellMask cells) const noexcept;

    /// Whether all of `cells` have an occluder that is everywhere closer than an inverse depth.
    bool all_occlude(double inverse_depth, CellMask cells) const noexcept;

    /// How deep the occluders lie at most.
    OccluderDepths max_depths() const noexcept;

    /// Whether all of `cells` have an occluder that is closer at the centre than an inverse depth.
    bool all_centres_occlude(double inverse_depth, CellMask cells) const noexcept;

private:
    glm::dvec2 centre_of(int cell) const noexcept {
        return {grid_.centre_u[static_cast<std::size_t>(cell % kGridSide)],
                grid_.centre_v[static_cast<std::size_t>(cell / kGridSide)]};
    }
    /// From a cell's centre to its corners.
    double max_change(const glm::dvec2& slope) const noexcept {
        return std::abs(slope.x) * grid_.half_cell[0] + std::abs(slope.y) * grid_.half_cell[1];
    }

    CellGrid grid_;
    CellMask occluded_ = 0;
    CellPlanes occluders_;
    std::array<double, 64> lowest_{};  // inverse depth in the cell, less what may be rounding
    std::array<geometry::FacetId, 64> facets_{};
};

/// Calls visit(cell) for every bit of a mask, lowest first.
template <typename Visit>
void for_each_cell(CellMask mask, Visit&& visit) {
    for (; mask != 0; mask &= mask - 1) {
        visit(std::countr_zero(mask));
    }
}

}  // namespace earshot::frustum
