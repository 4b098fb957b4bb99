// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/visible_facets.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

// The cross-section of a frustum in (u, v), and the visible part of a facet in it:
//
//     v ^
//       |  +----+----+----+----+   cells: sub-frusta
//       |  |    |    |    |    |   ...    outline of a facet
//       |  +----+----+----+----+   inner  cells that the facet covers wholly: it may occlude there
//       |  |    |.outer...|outer   outer  cells that the facet may overlap: it may be visible there
//       |  +----+:---+----+-:--+
//       |  |    |:   |inner:   |   The aperture is the bounding rectangle of the outer cells in
//       |  +----+:---+----+-:--+   which the facet is not occluded, cut to the facet's bounds. It
//       |  |    |:..outer...:  |   is the (u, v) rectangle of the frustum that the facet reflects.
//       |  +----+----+----+----+
//       +-----------------------> u

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

namespace {

/// The largest relative depth error of a facet that is used as an occluder.
constexpr double kMaxOccluderError = 0x1p-6;

InverseDepth scaled(const InverseDepth& depth, double factor) noexcept {
    return {.constant = factor * depth.constant, .slope = factor * depth.slope};
}

/// A lower bound of the inverse depth of points that lie `distance` metres (of depth) behind a
/// plane of inverse depth q: 1 / (1/q + distance) >= q / (1 + distance q_max).
InverseDepth depth_behind(const InverseDepth& depth, double distance, const Rect& rect) noexcept {
    return scaled(depth, 1.0 / (1.0 + distance * std::max(0.0, depth.max(rect))));
}

}  // namespace

bool may_pass(const Frustum& frustum,
              const VisibleFacet& visible,
              const Vec3& unfolded,
              double position_error) noexcept {
    const Vec3 p = frustum.local(unfolded);
    if (!(p.z > frustum.min_depth)) {
        return false;
    }
    const glm::dvec2 size = frustum.rect.upper - frustum.rect.lower;
    const double error = kProjectionErrorFactor * position_error / p.z;
    const double slack = kCellSlack * std::max(size.x, size.y) + error;
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    if (!(uv.x >= visible.aperture.lower.x - slack && uv.x <= visible.aperture.upper.x + slack &&
          uv.y >= visible.aperture.lower.y - slack && uv.y <= visible.aperture.upper.y + slack)) {
        return false;
    }
    const CoverageRaster raster(frustum.rect, frustum.cells);
    const glm::dvec2 cell = raster.cell_size();
    const double slack_in_cells = kCellSlack + error / std::min(cell.x, cell.y);
    return (raster.cells_overlapping({.lower = uv, .upper = uv}, slack_in_cells) & visible.cells) !=
           0;
}

VisibleFacets::VisibleFacets(const FacetIndex& index,
                             Mode mode,
                             double contact_radius,
                             double max_radius,
                             GrazingFacets grazing_facets)
    : index_(index),
      mode_(mode),
      contact_radius_(contact_radius),
      max_radius_(max_radius),
      grazing_facets_(grazing_facets),
      raster_(Rect{}, 1) {}

void VisibleFacets::set_frustum(const Frustum& frustum) {
    frustum_ = frustum;
    raster_ = CoverageRaster(frustum.rect, frustum.cells);
    occlusion_.reset(frustum.rect.lower + 0.5 * raster_.cell_size(), raster_.cell_size());
    position_error_ = kRounding * (index_.extent() + max_radius_ + glm::length(frustum.apex));
    outline_view_ = outline_view(frustum_, raster_);
    candidates_.clear();
    visible_facets_.clear();
}

void VisibleFacets::set_frustum(const Frustum& frustum, std::span<const VisibleFacet> visible) {
    set_frustum(frustum);
    visible_facets_.assign(visible.begin(), visible.end());
}

void VisibleFacets::filter(std::span<const std::uint8_t> mask) {
    std::erase_if(visible_facets_,
                  [&](const VisibleFacet& visible) { return mask[visible.facet] == 0; });
}

void VisibleFacets::search(const Frustum& frustum) {
    set_frustum(frustum);
    if (frustum.starts_at_facet) {
        start_depth_limit_ = depth_behind(
            scaled(frustum.start,
                   1.0 - depth_error(height_above(index_.plane(frustum.facet), frustum.apex))),
            contact_radius_,
            frustum.rect);
    }
    visit_nodes();
    collect_found();
}

// A facet whose plane contains the apex neither reflects sound from it (PathVerifier rejects
// sources within at least the first of these heights) nor covers a sub-frustum. PathVerifier has no
// such limit for the height of a listener or its image. For an apex there, the visible part of a
// facet is computed only if the height exceeds its own error by a margin.
double VisibleFacets::max_grazing_height() const noexcept {
    constexpr double kErrorMargin = 64.0;
    return grazing_facets_ == GrazingFacets::skip ? kRounding * index_.extent()
                                                  : kErrorMargin * position_error_;
}

// The height of the apex above a plane has the position error of the apex. The relative error of
// the inverse depth is the relative error of that height.
double VisibleFacets::depth_error(double height) const noexcept {
    return kProjectionErrorFactor * position_error_ / std::abs(height);
}

// Traverses the tree depth first, closer children first, so that occluders are added before the
// facets that they occlude are tested.
void VisibleFacets::visit_nodes() {
    const auto nodes = index_.tree().nodes();
    if (nodes.empty()) {
        return;
    }
    const FrustumBoxTest test(frustum_, box_cull().half_spaces(), position_error_);
    stack_.assign(1, {.cells = frustum_.active});
    while (!stack_.empty()) {
        const Seen top = stack_.back();
        stack_.pop_back();
        if (is_occluded(top)) {
            continue;
        }
        if ((top.child & FacetNode::kFacetFlag) != 0) {
            visit_facet(top.child & ~FacetNode::kFacetFlag);
        } else {
            push_children(test, nodes[top.child]);
        }
    }
}

// Those that the frustum's active cells may contain, the closest last.
void VisibleFacets::push_children(const FrustumBoxTest& test, const FacetNode& node) {
    ChildBounds boxes;
    const std::size_t first = stack_.size();
    for (std::uint32_t bits = project_boxes(test, node, boxes); bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        Seen seen = {.child = node.child[i],
                     .centre_depth = boxes.centre_depth[i],
                     .cells = frustum_.active};
        if (boxes.min_depth[i] > frustum_.min_depth) {
            seen.min_depth = boxes.min_depth[i];
            seen.cells &= mode_ == Mode::sampled ? cells_with_centre_in(boxes, i) : boxes.cells[i];
        }
        if (seen.cells == 0) {
            continue;
        }
        std::size_t place = stack_.size();
        stack_.push_back(seen);
        for (; place > first && stack_[place - 1].centre_depth < seen.centre_depth; --place) {
            stack_[place] = stack_[place - 1];
        }
        stack_[place] = seen;
    }
}

CellMask VisibleFacets::cells_with_centre_in(const ChildBounds& boxes,
                                             std::size_t i) const noexcept {
    return raster_.cells_with_centre_in({.lower = {boxes.lower[0][i], boxes.lower[1][i]},
                                         .upper = {boxes.upper[0][i], boxes.upper[1][i]}});
}

// Whether every sub-frustum that a box may overlap has an occluder in front of the box's closest
// corner.
bool VisibleFacets::is_occluded(const Seen& seen) const noexcept {
    if (seen.min_depth == 0.0 || (seen.cells & ~occlusion_.occluded()) != 0) {
        return false;
    }
    return mode_ == Mode::sampled ? occlusion_.all_centres_occlude(1.0 / seen.min_depth, seen.cells)
                                  : all_occlude_depth(seen.min_depth, seen.cells);
}

void VisibleFacets::visit_facet(FacetId facet) {
    if (frustum_.starts_at_facet && facet == frustum_.facet) {
        return;
    }
    const Plane& plane = index_.plane(facet);
    const double height = height_above(plane, frustum_.apex);
    if (std::abs(height) <= max_grazing_height()) {
        if (grazing_facets_ == GrazingFacets::keep) {
            visible_facets_.push_back({facet, frustum_.rect, frustum_.active, true});
        }
        return;
    }
    Projected projected;
    if (!draw(outline_view_, frustum_.rect, raster_, facet, mode_ == Mode::sampled, projected)) {
        return;
    }
    const InverseDepth depth = frustum_.inverse_depth(plane, height);
    const bool reflects = height > 0.0 || !index_.is_one_sided(facet);
    const CellMask outer = projected.coverage.outer & frustum_.active;
    if (index_.is_opaque(facet)) {
        if (mode_ == Mode::sampled) {
            occlusion_.add(facet, depth, projected.coverage.centre_sampled & frustum_.active);
        } else {
            add_occluder(facet, height, depth, projected.coverage.inner & frustum_.active);
        }
    }
    if (reflects && outer != 0) {
        const InverseDepth closest = scaled(depth, 1.0 + depth_error(height));
        candidates_.push_back({facet, closest, outer, projected.bounds});
    }
}

void VisibleFacets::add_occluder(FacetId facet,
                                 double height,
                                 const InverseDepth& depth,
                                 CellMask inner) {
    if (inner == 0) {
        return;
    }
    // The facet's triangles are the occluders, and they may deviate from its plane.
    const double error =
        kProjectionErrorFactor * (position_error_ + index_.deviation(facet)) / std::abs(height);
    if (error > kMaxOccluderError) {
        return;
    }
    // The facet occludes only in cells where it lies beyond the start of the frustum by more than
    // the contact radius.
    if (frustum_.starts_at_facet) {
        inner =
            occlusion_.cells_where_closer(start_depth_limit_, scaled(depth, 1.0 + error), inner);
    }
    const InverseDepth back =
        depth_behind(scaled(depth, 1.0 - error), contact_radius_, frustum_.rect);
    occlusion_.add(facet, back, inner);
}

BoxCull VisibleFacets::box_cull() const noexcept {
    const Plane* start_plane = frustum_.starts_at_facet ? &index_.plane(frustum_.facet) : nullptr;
    return {frustum_, start_plane, position_error_};
}

// Nothing of a box that is not wholly in front of the apex.
std::optional<VisibleFacets::BoxBounds> VisibleFacets::bounds_of(
    const geometry::Aabb& box) const noexcept {
    // The bounds of the box along the frustum's axes. Their quotients bound u and v of its points.
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
    const double min_depth = centre.z - extent.z;
    if (!(min_depth > frustum_.min_depth)) {
        return std::nullopt;
    }
    const double near_scale = 1.0 / min_depth;
    const double far_scale = 1.0 / (centre.z + extent.z);
    Rect bounds;
    for (int k = 0; k < 2; ++k) {
        const double low = centre[k] - extent[k];
        const double high = centre[k] + extent[k];
        bounds.lower[k] = low * (low < 0.0 ? near_scale : far_scale);
        bounds.upper[k] = high * (high < 0.0 ? far_scale : near_scale);
    }
    return BoxBounds{bounds, min_depth};
}

bool VisibleFacets::may_overlap(const geometry::Aabb& box,
                                const OccluderDepths& occluders) const noexcept {
    const auto seen = bounds_of(box);
    if (!seen) {
        return true;
    }
    const double depth = seen->min_depth - position_error_;
    const CellMask cells = cells_overlapping(seen->bounds, seen->min_depth);
    return cells != 0 && !(depth > position_error_ && occluders.hide(depth, cells));
}

void VisibleFacets::collect_found() {
    for (const Candidate& candidate : candidates_) {
        CellMask cells = candidate.outer;
        if (mode_ == Mode::complete) {
            cells &= ~occlusion_.cells_occluding(candidate.facet, candidate.depth, cells);
        } else if (index_.is_opaque(candidate.facet)) {
            cells = occlusion_.cells_occluded_by(candidate.facet, cells);
        }
        if (cells == 0) {
            continue;
        }
        Rect aperture = bounds_of_cells(cells);
        if (mode_ == Mode::complete) {
            aperture.lower = glm::max(aperture.lower, candidate.bounds.lower);
            aperture.upper = glm::min(aperture.upper, candidate.bounds.upper);
        }
        visible_facets_.push_back({candidate.facet, aperture, cells});
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

// The active sub-frusta that may contain points within `bounds` at a depth of at least `depth`
// metres.
CellMask VisibleFacets::cells_overlapping(const Rect& bounds, double depth) const noexcept {
    const glm::dvec2 cell = raster_.cell_size();
    const double slack =
        kCellSlack + kProjectionErrorFactor * position_error_ / depth / std::min(cell.x, cell.y);
    return raster_.cells_overlapping(bounds, slack) & frustum_.active;
}

// Whether every cell has an occluder at a depth of less than `depth` metres.
bool VisibleFacets::all_occlude_depth(double depth, CellMask cells) const noexcept {
    if (!(depth > 2.0 * position_error_)) {
        return false;
    }
    return occlusion_.all_occlude(1.0 / (depth - position_error_), cells);
}

bool VisibleFacets::may_arrive_at(const Vec3& point) const noexcept {
    if (frustum_.starts_at_facet &&
        frustum_.side * index_.plane(frustum_.facet).distance(point) < -position_error_) {
        return false;
    }
    const Vec3 p = frustum_.local(point);
    if (!(p.z > frustum_.min_depth)) {
        return false;
    }
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    const CellMask cells = cells_overlapping({.lower = uv, .upper = uv}, p.z);
    if (cells == 0 || mode_ == Mode::sampled) {
        return cells != 0;
    }
    return !all_occlude_depth(p.z, cells);
}

bool VisibleFacets::may_reflect_to(const VisibleFacet& visible, const Vec3& point) const noexcept {
    const Plane& plane = index_.plane(visible.facet);
    const double side = plane.distance(frustum_.apex) > 0.0 ? 1.0 : -1.0;
    if (side * plane.distance(point) < -position_error_) {
        return false;
    }
    return may_pass(visible, plane.mirror(point));
}

ApertureTest VisibleFacets::aperture_test() const noexcept {
    const Vec3* axes[] = {&frustum_.right, &frustum_.up, &frustum_.forward};
    ApertureTest test;
    for (int k = 0; k < 3; ++k) {
        test.apex[k] = frustum_.apex[k];
        for (int axis = 0; axis < 3; ++axis) {
            test.axes[axis][k] = (*axes[axis])[k];
        }
    }
    for (int k = 0; k < 2; ++k) {
        test.margin_per_depth[k] = 0.5 * raster_.cell_size()[k];
    }
    test.margin = kProjectionErrorFactor * position_error_;
    test.min_depth = frustum_.min_depth;
    return test;
}

bool VisibleFacets::may_pass(const VisibleFacet& visible, const Vec3& unfolded) const noexcept {
    const Vec3 p = frustum_.local(unfolded);
    if (!(p.z > frustum_.min_depth)) {
        return false;
    }
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    return (cells_overlapping({.lower = uv, .upper = uv}, p.z) & visible.cells) != 0;
}

Frustum VisibleFacets::reflect(const VisibleFacet& visible) {
    Frustum child =
        mirrored(frustum_, index_.plane(visible.facet), visible.facet, visible.aperture);
    child.max_pressure_factor =
        frustum_.max_pressure_factor * index_.max_pressure_factor(visible.facet);
    CoverageRaster raster(child.rect, child.cells);
    Projected own;
    // Draw the facet itself in the parent: (u, v) is the same in the parent and the child.
    Frustum aperture = frustum_;
    aperture.rect = child.rect;
    const OutlineView view = outline_view(aperture, raster);
    const bool is_seen = draw(view, aperture.rect, raster, visible.facet, false, own);
    child.active = is_seen ? own.coverage.outer : 0;
    const glm::dvec2 size = raster_.cell_size();
    const double slack = kCellSlack + kApertureSlack / std::min(size.x, size.y);
    child.active &= raster.cells_overlapping_grid(raster_, visible.cells, slack);
    return child;
}

}  // namespace earshot::frustum
