// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/occlusion_grid.h"

#include "earshot/geometry/aabb.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace earshot::frustum {

using geometry::FacetId;

namespace {

/// Relative slack for rounding in inverse depths, which are sums of three products.
constexpr double kDepthSlack = 0x1p-40;

double size_of(const InverseDepth& depth) noexcept {
    return std::abs(depth.constant) + std::abs(depth.slope.x) + std::abs(depth.slope.y);
}

}  // namespace

bool OccluderDepths::hide(double depth, CellMask cells) const noexcept {
    const double limit = (1.0 + 2.0 * kDepthSlack) / depth;
    for (; cells != 0; cells &= cells - 1) {
        const auto bits =
            static_cast<std::uint32_t>(inverse[static_cast<std::size_t>(std::countr_zero(cells))]);
        if (!(static_cast<double>(std::bit_cast<float>(bits << 16)) > limit)) {
            return false;
        }
    }
    return true;
}

void OcclusionGrid::reset(const glm::dvec2& first_centre, const glm::dvec2& cell_size) noexcept {
    for (int i = 0; i < kGridSide; ++i) {
        const auto cell = static_cast<std::size_t>(i);
        grid_.centre_u[cell] = first_centre.x + i * cell_size.x;
        grid_.centre_v[cell] = first_centre.y + i * cell_size.y;
    }
    grid_.half_cell[0] = 0.5 * cell_size.x;
    grid_.half_cell[1] = 0.5 * cell_size.y;
    grid_.rounding = kDepthSlack;
    occluded_ = 0;
}

void OcclusionGrid::add(FacetId facet, const InverseDepth& depth, CellMask cells) noexcept {
    const double size = size_of(depth);
    const double below_centre = max_change(depth.slope) + kDepthSlack * size;
    for_each_cell(cells, [&](int cell) {
        const auto i = static_cast<std::size_t>(cell);
        const double centre = depth.at(centre_of(cell));
        const CellMask bit = CellMask{1} << cell;
        // At the same depth the lower facet, whatever the order in which a tree visits them.
        if ((occluded_ & bit) == 0 || centre > occluders_.centre[i] ||
            (centre == occluders_.centre[i] && facet < facets_[i])) {
            occluders_.centre[i] = centre;
            occluders_.slope_u[i] = depth.slope.x;
            occluders_.slope_v[i] = depth.slope.y;
            occluders_.size[i] = size;
            lowest_[i] = centre - below_centre;
            facets_[i] = facet;
            occluded_ |= bit;
        }
    });
}

CellMask OcclusionGrid::cells_occluded_by(FacetId facet, CellMask cells) const noexcept {
    CellMask owned = 0;
    for_each_cell(occluded_ & cells, [&](int cell) {
        const bool is_owner = facets_[static_cast<std::size_t>(cell)] == facet;
        owned |= static_cast<CellMask>(is_owner) << cell;
    });
    return owned;
}

CellMask OcclusionGrid::cells_where_closer(const InverseDepth& a,
                                           const InverseDepth& b,
                                           CellMask cells) const noexcept {
    const glm::dvec2 slope = a.slope - b.slope;
    const PlaneOverCells difference = {
        a.constant - b.constant, slope.x, slope.y, size_of(a) + size_of(b)};
    return cells_above(grid_, difference, max_change(slope) + kDepthSlack * difference.size, cells);
}

CellMask OcclusionGrid::cells_occluding(FacetId facet,
                                        const InverseDepth& depth,
                                        CellMask cells) const noexcept {
    const PlaneOverCells plane = {depth.constant, depth.slope.x, depth.slope.y, size_of(depth)};
    const CellMask occluding = cells_before(occluders_, grid_, plane, cells & occluded_);
    return occluding & ~cells_occluded_by(facet, occluding);
}

bool OcclusionGrid::all_occlude(double inverse_depth, CellMask cells) const noexcept {
    if ((cells & ~occluded_) != 0) {
        return false;
    }
    const double limit = (1.0 + kDepthSlack) * inverse_depth;
    for (; cells != 0; cells &= cells - 1) {
        if (!(lowest_[static_cast<std::size_t>(std::countr_zero(cells))] > limit)) {
            return false;
        }
    }
    return true;
}

// Cutting off the lower half of a positive float rounds it down.
OccluderDepths OcclusionGrid::max_depths() const noexcept {
    OccluderDepths depths;
    for_each_cell(occluded_, [&](int cell) {
        const auto i = static_cast<std::size_t>(cell);
        const float bound = geometry::round_down(lowest_[i]);
        if (bound > 0.0F) {
            depths.inverse[i] =
                static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(bound) >> 16);
        }
    });
    return depths;
}

bool OcclusionGrid::all_centres_occlude(double inverse_depth, CellMask cells) const noexcept {
    if ((cells & ~occluded_) != 0) {
        return false;
    }
    for (; cells != 0; cells &= cells - 1) {
        const auto cell = static_cast<std::size_t>(std::countr_zero(cells));
        if (!(occluders_.centre[cell] > inverse_depth)) {
            return false;
        }
    }
    return true;
}

}  // namespace earshot::frustum
