// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/visible_facets.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

namespace {

/// Relative room for rounding in inverse depths, which are sums of three products.
constexpr double kDepthSlack = 0x1p-40;

/// A facet whose depth is known worse than this is not trusted to hide anything.
constexpr double kGrazingCover = 0x1p-6;

InverseDepth scaled(const InverseDepth& depth, double factor) noexcept {
    return {.constant = factor * depth.constant, .slope = factor * depth.slope};
}

double size_of(const InverseDepth& depth) noexcept {
    return std::abs(depth.constant) + std::abs(depth.slope.x) + std::abs(depth.slope.y);
}

/// The inverse depth of points `reach` metres (of depth) behind a plane, or less: 1 / (1/q + reach)
/// >= q / (1 + reach q_max).
InverseDepth pushed_back(const InverseDepth& depth, double reach, const Rect& rect) noexcept {
    return scaled(depth, 1.0 / (1.0 + reach * std::max(0.0, depth.greatest(rect))));
}

template <typename Visit>
void for_each_cell(CellMask mask, Visit&& visit) {
    for (; mask != 0; mask &= mask - 1) {
        visit(std::countr_zero(mask));
    }
}

}  // namespace

bool may_pass_window(const Frustum& frustum,
                     const Rect& window,
                     const Vec3& unfolded,
                     double moved) noexcept {
    const Vec3 p = frustum.local(unfolded);
    if (!(p.z > frustum.least_depth)) {
        return false;
    }
    const glm::dvec2 size = frustum.rect.upper - frustum.rect.lower;
    const double slack = kCellSlack * std::max(size.x, size.y) + kSpread * moved / p.z;
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    return uv.x >= window.lower.x - slack && uv.x <= window.upper.x + slack &&
           uv.y >= window.lower.y - slack && uv.y <= window.upper.y + slack;
}

VisibleFacets::VisibleFacets(
    const FacetIndex& index, Mode mode, double contact_reach, double reach, Grazing grazing)
    : index_(index),
      mode_(mode),
      contact_reach_(contact_reach),
      reach_(reach),
      grazing_(grazing),
      raster_(Rect{}, 1) {}

void VisibleFacets::enter(const Frustum& frustum) {
    frustum_ = frustum;
    raster_ = CellRaster(frustum.rect, frustum.cells);
    first_centre_ = frustum.rect.lower + 0.5 * raster_.cell_size();
    moved_ = kRounding * (index_.scale() + reach_ + glm::length(frustum.apex));
    covered_ = 0;
    candidates_.clear();
    found_.clear();
}

void VisibleFacets::leave_out(std::span<const std::uint8_t> is_wanted) {
    std::erase_if(found_, [&](const VisibleFacet& seen) { return is_wanted[seen.facet] == 0; });
}

void VisibleFacets::search(const Frustum& frustum) {
    enter(frustum);
    if (frustum.starts_at_facet) {
        start_limit_ = pushed_back(
            scaled(frustum.start, 1.0 - depth_error(frustum.facet)), contact_reach_, frustum.rect);
    }
    visit_nodes();
    collect_found();
}

// In the plane of its apex a facet neither reflects (PathVerifier::grazing_distance is at least the
// first of these) nor fills a sub-frustum. Verification does not ask how high a listener or its
// image lies: from there a facet counts only where the height is known well.
double VisibleFacets::grazing_height() const noexcept {
    constexpr double kWellKnown = 64.0;
    return grazing_ == Grazing::drop ? kRounding * index_.scale() : kWellKnown * moved_;
}

// An apex known to moved_ metres has a height over a plane that is off by that much; the inverse
// depth is off by the same share.
double VisibleFacets::depth_error(FacetId facet) const noexcept {
    return kSpread * moved_ / std::abs(index_.plane(facet).distance(frustum_.apex));
}

// Nearer children first, so that covers are known before what they hide.
void VisibleFacets::visit_nodes() {
    const auto nodes = index_.tree().nodes();
    if (nodes.empty()) {
        return;
    }
    const Plane* start_plane = frustum_.starts_at_facet ? &index_.plane(frustum_.facet) : nullptr;
    const BoxCull cull(frustum_, start_plane, moved_);
    const auto depth_of = [&](const geometry::Aabb& box) {
        double depth = 0.0;
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            depth += frustum_.forward[k] *
                     (static_cast<double>(box.lower[axis]) + static_cast<double>(box.upper[axis]));
        }
        return depth;
    };
    stack_.assign(1, 0);
    while (!stack_.empty()) {
        const bvh::Node& node = nodes[stack_.back()];
        stack_.pop_back();
        if (!cull.may_meet(node.box) || box_is_hidden(node.box)) {
            continue;
        }
        if (node.is_leaf()) {
            for (std::uint32_t i = 0; i < node.count; ++i) {
                visit_facet(index_.tree().primitives()[node.first + i]);
            }
        } else {
            const bool left_first =
                depth_of(nodes[node.first].box) <= depth_of(nodes[node.first + 1].box);
            stack_.push_back(left_first ? node.first + 1 : node.first);
            stack_.push_back(left_first ? node.first : node.first + 1);
        }
    }
}

void VisibleFacets::visit_facet(FacetId facet) {
    if (frustum_.starts_at_facet && facet == frustum_.facet) {
        return;
    }
    const double height = index_.plane(facet).distance(frustum_.apex);
    if (std::abs(height) <= grazing_height()) {
        if (grazing_ == Grazing::keep) {
            found_.push_back({facet, frustum_.rect, frustum_.alive, true});
        }
        return;
    }
    Projected projected;
    if (!draw(frustum_, raster_, facet, mode_ == Mode::sampled, projected)) {
        return;
    }
    const InverseDepth depth = frustum_.inverse_depth(index_.plane(facet));
    const bool reflects = height > 0.0 || !index_.is_one_sided(facet);
    const CellMask touched = projected.coverage.touched & frustum_.alive;
    if (mode_ == Mode::sampled) {
        add_sample(facet, depth, projected.coverage.centred & frustum_.alive);
    } else {
        add_cover(facet, depth, projected.coverage.filled & frustum_.alive);
    }
    if (reflects && touched != 0) {
        const InverseDepth nearest = scaled(depth, 1.0 + depth_error(facet));
        candidates_.push_back({facet, nearest, touched, projected.bounds});
    }
}

void VisibleFacets::add_cover(FacetId facet, const InverseDepth& depth, CellMask filled) {
    if (filled == 0 || index_.transmissive(facet)) {
        return;
    }
    // Its triangles hide, which may lie beside its plane.
    const double error = kSpread * (moved_ + index_.deviation(facet)) /
                         std::abs(index_.plane(facet).distance(frustum_.apex));
    if (error > kGrazingCover) {
        return;
    }
    const InverseDepth back =
        pushed_back(scaled(depth, 1.0 - error), contact_reach_, frustum_.rect);
    const InverseDepth near = scaled(depth, 1.0 + error);
    const double back_size = size_of(back);
    const double start_margin =
        kDepthSlack * (size_of(start_limit_) + size_of(near)) + half_change(start_limit_, near);
    for_each_cell(filled, [&](int cell) {
        const glm::dvec2 middle = centre_of(cell);
        if (frustum_.starts_at_facet &&
            !(start_limit_.at(middle) - near.at(middle) > start_margin)) {
            return;
        }
        Cover& cover = covers_[static_cast<std::size_t>(cell)];
        const double centre = back.at(middle);
        const CellMask bit = CellMask{1} << cell;
        if ((covered_ & bit) == 0 || centre > cover.centre) {
            cover = {facet, back, centre, back_size};
            covered_ |= bit;
        }
    });
}

void VisibleFacets::add_sample(FacetId facet, const InverseDepth& depth, CellMask centred) {
    if (index_.transmissive(facet)) {
        return;
    }
    for_each_cell(centred, [&](int cell) {
        Cover& cover = covers_[static_cast<std::size_t>(cell)];
        const double centre = depth.at(centre_of(cell));
        const CellMask bit = CellMask{1} << cell;
        if ((covered_ & bit) == 0 || centre > cover.centre) {
            cover = {facet, depth, centre, size_of(depth)};
            covered_ |= bit;
        }
    });
}

// A box is hidden if every sub-frustum it may meet is filled by something nearer than its nearest
// corner.
bool VisibleFacets::box_is_hidden(const geometry::Aabb& box) const noexcept {
    if (covered_ == 0 && mode_ == Mode::complete) {
        return false;
    }
    // The box's extent along the frustum's axes; quotients of its ends bound the quotients of its
    // points.
    Vec3 middle, half;
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        const auto lower = static_cast<double>(box.lower[axis]);
        const auto upper = static_cast<double>(box.upper[axis]);
        middle[k] = 0.5 * (lower + upper);
        half[k] = 0.5 * (upper - lower);
    }
    const Vec3 centre = frustum_.local(middle);
    const Vec3 extent = {glm::dot(glm::abs(frustum_.right), half),
                         glm::dot(glm::abs(frustum_.up), half),
                         glm::dot(glm::abs(frustum_.forward), half)};
    const double nearest = centre.z - extent.z;
    if (!(nearest > frustum_.least_depth)) {
        return false;
    }
    const double near_scale = 1.0 / nearest;
    const double far_scale = 1.0 / (centre.z + extent.z);
    Rect bounds;
    for (int k = 0; k < 2; ++k) {
        const double low = centre[k] - extent[k];
        const double high = centre[k] + extent[k];
        bounds.lower[k] = low * (low < 0.0 ? near_scale : far_scale);
        bounds.upper[k] = high * (high < 0.0 ? far_scale : near_scale);
    }
    if (mode_ == Mode::sampled) {
        return samples_pass(bounds, nearest);
    }
    const CellMask cells = cells_near(bounds, nearest);
    return (cells & ~covered_) == 0 && everything_hides(nearest, cells);
}

// Whether no sample meets a box before it has met a facet.
bool VisibleFacets::samples_pass(const Rect& bounds, double nearest) const noexcept {
    const CellMask cells = raster_.cells_centred_in(bounds) & frustum_.alive;
    if ((cells & ~covered_) != 0) {
        return false;
    }
    const double front = 1.0 / nearest;
    CellMask behind = 0;
    for_each_cell(cells, [&](int cell) {
        const Cover& cover = covers_[static_cast<std::size_t>(cell)];
        behind |= static_cast<CellMask>(cover.centre > front) << cell;
    });
    return behind == cells;
}

// Whether a cover is nearer than a plane everywhere in a cell, by more than rounding.
bool VisibleFacets::is_nearer(const Cover& cover,
                              const InverseDepth& depth,
                              double size,
                              int cell) const noexcept {
    return cover.centre - depth.at(centre_of(cell)) >
           half_change(cover.depth, depth) + kDepthSlack * (cover.size + size);
}

glm::dvec2 VisibleFacets::centre_of(int cell) const noexcept {
    return {first_centre_.x + cell % kGridSide * raster_.cell_size().x,
            first_centre_.y + cell / kGridSide * raster_.cell_size().y};
}

// By how much the difference of two inverse depths changes from a cell's centre to its corners, at
// most.
double VisibleFacets::half_change(const InverseDepth& a, const InverseDepth& b) const noexcept {
    return 0.5 * (std::abs(a.slope.x - b.slope.x) * raster_.cell_size().x +
                  std::abs(a.slope.y - b.slope.y) * raster_.cell_size().y);
}

CellMask VisibleFacets::hidden_cells(FacetId facet,
                                     const InverseDepth& depth,
                                     CellMask cells) const noexcept {
    CellMask hidden = 0;
    const double size = size_of(depth);
    for_each_cell(cells & covered_, [&](int cell) {
        const Cover& cover = covers_[static_cast<std::size_t>(cell)];
        if (cover.facet != facet && is_nearer(cover, depth, size, cell)) {
            hidden |= CellMask{1} << cell;
        }
    });
    return hidden;
}

void VisibleFacets::collect_found() {
    for (const Candidate& candidate : candidates_) {
        CellMask cells = candidate.touched;
        if (mode_ == Mode::sampled && !index_.transmissive(candidate.facet)) {
            CellMask won = 0;
            for_each_cell(covered_ & cells, [&](int cell) {
                won |= static_cast<CellMask>(covers_[static_cast<std::size_t>(cell)].facet ==
                                             candidate.facet)
                       << cell;
            });
            cells = won;
        } else if (mode_ == Mode::complete) {
            cells &= ~hidden_cells(candidate.facet, candidate.depth, cells);
        }
        if (cells == 0) {
            continue;
        }
        Rect window = bounds_of_cells(cells);
        if (mode_ == Mode::complete) {
            window.lower = glm::max(window.lower, candidate.bounds.lower);
            window.upper = glm::min(window.upper, candidate.bounds.upper);
        }
        found_.push_back({candidate.facet, window, cells});
    }
}

Rect VisibleFacets::bounds_of_cells(CellMask cells) const noexcept {
    CellMask columns = cells;
    columns |= columns >> 32;
    columns |= columns >> 16;
    columns |= columns >> 8;
    columns &= 0xff;
    const int first_row = std::countr_zero(cells) / kGridSide;
    const int last_row = (63 - std::countl_zero(cells)) / kGridSide;
    const int first_column = std::countr_zero(columns);
    const int last_column = 63 - std::countl_zero(columns);
    return {.lower = raster_.cell_rect(first_row, first_column).lower,
            .upper = raster_.cell_rect(last_row, last_column).upper};
}

// The live sub-frusta that points within `bounds`, `depth` metres away or more, may lie in.
CellMask VisibleFacets::cells_near(const Rect& bounds, double depth) const noexcept {
    const glm::dvec2 cell = raster_.cell_size();
    const double slack = kCellSlack + kSpread * moved_ / depth / std::min(cell.x, cell.y);
    return raster_.cells_of(bounds, slack) & frustum_.alive;
}

bool VisibleFacets::everything_hides(double depth, CellMask cells) const noexcept {
    if (!(depth > 2.0 * moved_)) {
        return false;
    }
    const InverseDepth front = {.constant = 1.0 / (depth - moved_), .slope = glm::dvec2(0.0)};
    for (; cells != 0; cells &= cells - 1) {
        const int cell = std::countr_zero(cells);
        if ((covered_ >> cell & 1) == 0 ||
            !is_nearer(covers_[static_cast<std::size_t>(cell)], front, front.constant, cell)) {
            return false;
        }
    }
    return true;
}

bool VisibleFacets::may_reach(const Vec3& point) const noexcept {
    if (frustum_.starts_at_facet &&
        frustum_.side * index_.plane(frustum_.facet).distance(point) < -moved_) {
        return false;
    }
    const Vec3 p = frustum_.local(point);
    if (!(p.z > frustum_.least_depth)) {
        return false;
    }
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    const CellMask cells = cells_near({.lower = uv, .upper = uv}, p.z);
    if (cells == 0 || mode_ == Mode::sampled) {
        return cells != 0;
    }
    return !everything_hides(p.z, cells);
}

bool VisibleFacets::may_reach_mirrored(const VisibleFacet& visible,
                                       const Vec3& point) const noexcept {
    const Plane& plane = index_.plane(visible.facet);
    const double side = plane.distance(frustum_.apex) > 0.0 ? 1.0 : -1.0;
    if (side * plane.distance(point) < -moved_) {
        return false;
    }
    return may_pass(visible, plane.mirror(point));
}

WindowSight VisibleFacets::sight() const noexcept {
    const Vec3* axes[] = {&frustum_.right, &frustum_.up, &frustum_.forward};
    WindowSight sight;
    for (int k = 0; k < 3; ++k) {
        sight.apex[k] = frustum_.apex[k];
        for (int axis = 0; axis < 3; ++axis) {
            sight.axes[axis][k] = (*axes[axis])[k];
        }
    }
    for (int k = 0; k < 2; ++k) {
        sight.share[k] = 0.5 * raster_.cell_size()[k];
    }
    sight.reach = kSpread * moved_;
    sight.least_depth = frustum_.least_depth;
    return sight;
}

bool VisibleFacets::may_pass(const VisibleFacet& visible, const Vec3& unfolded) const noexcept {
    const Vec3 p = frustum_.local(unfolded);
    if (!(p.z > frustum_.least_depth)) {
        return false;
    }
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    return (cells_near({.lower = uv, .upper = uv}, p.z) & visible.cells) != 0;
}

Frustum VisibleFacets::reflect(const VisibleFacet& visible) {
    Frustum child = mirrored(frustum_, index_.plane(visible.facet), visible.facet, visible.window);
    child.max_pressure_factor =
        frustum_.max_pressure_factor * index_.max_pressure_factor(visible.facet);
    CellRaster raster(child.rect, child.cells);
    Projected own;
    // The facet itself, drawn from the parent's side: (u, v) is the same for both.
    Frustum aperture = frustum_;
    aperture.rect = child.rect;
    child.alive = draw(aperture, raster, visible.facet, false, own) ? own.coverage.touched : 0;
    const glm::dvec2 size = raster_.cell_size();
    const double slack = kCellSlack + kWindowSlack / std::min(size.x, size.y);
    child.alive &= raster.cells_meeting(raster_, visible.cells, slack);
    return child;
}

}  // namespace earshot::frustum
