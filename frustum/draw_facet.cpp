// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/outline_view.h"
#include "earshot/frustum/internal/visible_facets.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

namespace {

/// Polygons are clipped this far outside the grid, in cells, beyond the position error of their
/// vertices, so that the new edges mark no cell.
constexpr double kClipMargin = 1.0;

/// Polygons that extend no farther outside the grid than this, in cells, need not be clipped: the
/// rounding of where they cross the grid's lines (2^-50 of it) is far below kCellSlack.
constexpr double kMaxOutside = 0x1p16;

/// A polygon narrower than this, in cells, covers no cell wholly.
constexpr double kAlmostACell = 0.99;

/// The vertices of all loops.
std::span<const Vec3> outline_of(const FacetIndex& index, FacetId facet) noexcept {
    const auto loops = index.loops(facet);
    return index.vertices().subspan(loops.front().begin, loops.back().end - loops.front().begin);
}

}  // namespace

/// The half-spaces that facets are clipped to: beyond the facet where the frustum starts, at its
/// least depth, and the four sides of the grid grown by a margin, all moved outward by the position
/// error of the polygon's points, metres.
struct VisibleFacets::ClipPlanes {
    static constexpr std::size_t kCount = 6;

    ClipPlanes(const Frustum& the_frustum,
               const FacetIndex& index,
               const CoverageRaster& raster,
               double the_position_error) noexcept
        : frustum(the_frustum),
          position_error(the_position_error),
          start_slack(
              the_frustum.starts_at_facet
                  ? the_position_error /
                        std::abs(height_above(index.plane(the_frustum.facet), the_frustum.apex))
                  : 0.0),
          side_error(kProjectionErrorFactor * the_position_error),
          lower(the_frustum.rect.lower - kClipMargin * raster.cell_size()),
          upper(the_frustum.rect.upper + kClipMargin * raster.cell_size()) {}

    /// Calls visit(distance) for each plane in turn while it returns true; points inside have a
    /// distance that is not negative. Returns whether all did.
    template <typename Visit>
    bool for_each(Visit&& visit) const {
        return visit([&](const Vec3& p) { return before_start(p); }) &&
               visit([&](const Vec3& p) { return p.z - frustum.min_depth + position_error; }) &&
               visit([&](const Vec3& p) { return p.x - lower.x * p.z + side_error; }) &&
               visit([&](const Vec3& p) { return upper.x * p.z - p.x + side_error; }) &&
               visit([&](const Vec3& p) { return p.y - lower.y * p.z + side_error; }) &&
               visit([&](const Vec3& p) { return upper.y * p.z - p.y + side_error; });
    }

    /// 1 - depth * start(u, v) > 0 behind the start plane, up to the positive factor of its
    /// distance from the apex: points on the plane stay.
    double before_start(const Vec3& p) const noexcept {
        const InverseDepth& start = frustum.start;
        return frustum.starts_at_facet ? start.constant * p.z + start.slope.x * p.x +
                                             start.slope.y * p.y - 1.0 + start_slack
                                       : 0.0;
    }

    /// With these half-spaces. Points that are seen without clipping are no closer than twice what
    /// their errors can move them.
    OutlineView view() const noexcept {
        OutlineView view{};
        view.start_slack = 1.0;
        const Vec3* axes[] = {&frustum.right, &frustum.up, &frustum.forward};
        for (int k = 0; k < 3; ++k) {
            view.apex[k] = frustum.apex[k];
            for (int axis = 0; axis < 3; ++axis) {
                view.axes[axis][k] = (*axes[axis])[k];
            }
        }
        if (frustum.starts_at_facet) {
            view.start_constant = frustum.start.constant;
            view.start_slack = start_slack;
        }
        for (int k = 0; k < 2; ++k) {
            view.start_slope[k] = frustum.starts_at_facet ? frustum.start.slope[k] : 0.0;
            view.lower[k] = lower[k];
            view.upper[k] = upper[k];
        }
        view.side_error = side_error;
        view.min_depth = std::max(frustum.min_depth, 2.0 * side_error);
        view.clip_depth = frustum.min_depth - position_error;
        return view;
    }

    const Frustum& frustum;
    double position_error, start_slack, side_error;
    glm::dvec2 lower, upper;
};

// Draws a facet that lies wholly in the half-space of the frustum's depths, as most do, without
// clipping. If its bounds overlap a few cells only and it is too narrow to cover one, all of these
// are its outer cells and it has no inner one.
VisibleFacets::DrawResult VisibleFacets::draw_whole(const Frustum& frustum,
                                                    CoverageRaster& raster,
                                                    FacetId facet,
                                                    double position_error,
                                                    bool centres_only,
                                                    Projected& out) {
    const auto vertices = outline_of(index_, facet);
    // A triangle's last vertex is there twice.
    const std::array<Vec3, 4> four = {vertices[0], vertices[1], vertices[2], vertices.back()};
    const bool are_few = vertices.size() < four.size();
    outline_.resize(std::max(vertices.size(), four.size()));
    OutlineBounds seen;
    switch (view_outline(ClipPlanes(frustum, index_, raster, position_error).view(),
                         are_few ? &four.front().x : &vertices.front().x,
                         outline_.size(),
                         &outline_.front().x,
                         seen)) {
        case OutlineSeen::not_at_all:
            return DrawResult::outside;
        case OutlineSeen::partly:
            return DrawResult::needs_clipping;
        case OutlineSeen::whole:
            break;
    }
    const glm::dvec2 lower = {seen.lower[0], seen.lower[1]};
    const glm::dvec2 upper = {seen.upper[0], seen.upper[1]};
    const double min_depth = seen.min_depth;
    const glm::dvec2 cell = raster.cell_size();
    const double slack =
        kCellSlack + kProjectionErrorFactor * position_error / min_depth / std::min(cell.x, cell.y);
    out.bounds = {.lower = lower - slack * cell, .upper = upper + slack * cell};
    const CellMask near = raster.cells_overlapping({.lower = lower, .upper = upper}, slack);
    const bool overlaps_a_sample =
        !centres_only || raster.cells_with_centre_in({.lower = lower, .upper = upper}) != 0;
    if (near == 0 || !overlaps_a_sample) {
        return DrawResult::outside;
    }
    constexpr int kFewCells = 4;
    const glm::dvec2 size = (upper - lower) / cell;
    if ((!centres_only || std::popcount(near) <= kFewCells) &&
        (size.x < kAlmostACell || size.y < kAlmostACell)) {
        out.coverage = {.outer = near, .inner = 0, .centre_sampled = near};
        if (!centres_only) {
            return DrawResult::done;
        }
    }
    // Farther outside, the rounding of where an edge enters the grid would matter.
    const glm::dvec2 far = kMaxOutside * cell;
    if (glm::any(glm::lessThan(lower, frustum.rect.lower - far)) ||
        glm::any(glm::greaterThan(upper, frustum.rect.upper + far))) {
        return DrawResult::needs_clipping;
    }
    raster.start(slack, centres_only);
    const auto loops = index_.loops(facet);
    const std::uint32_t begin = loops.front().begin;
    for (const FacetIndex::LoopRange& loop : loops) {
        raster.add_loop(std::span(outline_).subspan(loop.begin - begin, loop.end - loop.begin));
    }
    out.coverage = raster.finish();
    return DrawResult::done;
}

// Draws a facet in perspective from the frustum's apex, beyond the facet where the frustum starts.
// Returns false if nothing of it is inside or, with `centres_only`, no centre of a cell.
bool VisibleFacets::draw(const Frustum& frustum,
                         CoverageRaster& raster,
                         FacetId facet,
                         bool centres_only,
                         Projected& out) {
    const double position_error = position_error_ + index_.flatness(facet);
    switch (draw_whole(frustum, raster, facet, position_error, centres_only, out)) {
        case DrawResult::outside:
            return false;
        case DrawResult::done:
            return true;
        case DrawResult::needs_clipping:
            break;
    }
    return draw_clipped(frustum, raster, facet, position_error, centres_only, out);
}

bool VisibleFacets::draw_clipped(const Frustum& frustum,
                                 CoverageRaster& raster,
                                 FacetId facet,
                                 double position_error,
                                 bool centres_only,
                                 Projected& out) {
    const auto vertices = outline_of(index_, facet);
    local_.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        local_[i] = frustum.local(vertices[i]);
    }
    const ClipPlanes planes(frustum, index_, raster, position_error);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto loops = index_.loops(facet);
    out.bounds = {.lower = glm::dvec2(kInfinity), .upper = glm::dvec2(-kInfinity)};
    double min_depth = kInfinity;
    outline_.clear();
    std::array<std::size_t, 16> few_ends{};
    std::vector<std::size_t> many_ends;
    if (loops.size() > few_ends.size()) {
        many_ends.resize(loops.size());
    }
    const std::span<std::size_t> ends =
        many_ends.empty() ? std::span(few_ends) : std::span(many_ends);
    for (std::size_t i = 0; i < loops.size(); ++i) {
        const auto first = local_.begin() + (loops[i].begin - loops.front().begin);
        polygon_.assign(first, first + (loops[i].end - loops[i].begin));
        if (clip(planes)) {
            for (const Vec3& p : polygon_) {
                min_depth = std::min(min_depth, p.z);
                outline_.emplace_back(p.x / p.z, p.y / p.z);
                out.bounds.lower = glm::min(out.bounds.lower, outline_.back());
                out.bounds.upper = glm::max(out.bounds.upper, outline_.back());
            }
        }
        ends[i] = outline_.size();
    }
    if (outline_.empty()) {
        return false;
    }
    const glm::dvec2 cell = raster.cell_size();
    if (min_depth < kProjectionErrorFactor * position_error) {
        // Closer to the apex than its position error: it may be visible in any direction.
        const CellMask all = raster.cells_overlapping(frustum.rect, 0.0);
        out.coverage = {.outer = all, .inner = 0, .centre_sampled = all};
        out.bounds = {.lower = frustum.rect.lower - cell, .upper = frustum.rect.upper + cell};
        return true;
    }
    const double slack_uv = kProjectionErrorFactor * position_error / min_depth;
    const double slack = kCellSlack + slack_uv / std::min(cell.x, cell.y);
    raster.start(slack, centres_only);
    std::size_t begin = 0;
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (ends[i] > begin) {
            raster.add_loop(std::span(outline_).subspan(begin, ends[i] - begin));
        }
        begin = ends[i];
    }
    out.coverage = raster.finish();
    out.bounds.lower -= slack * cell;
    out.bounds.upper += slack * cell;
    return true;
}

// Sutherland and Hodgman 1974.
bool VisibleFacets::clip(const ClipPlanes& planes) {
    const auto keep = [&](auto&& inside_distance) {
        bool all = true;
        bool any = false;
        for (const Vec3& p : polygon_) {
            const bool inside = inside_distance(p) >= 0.0;
            all = all && inside;
            any = any || inside;
        }
        if (all || !any) {
            return any;
        }
        clipped_.clear();
        Vec3 previous = polygon_.back();
        double before = inside_distance(previous);
        for (const Vec3& p : polygon_) {
            const double here = inside_distance(p);
            if ((before >= 0.0) != (here >= 0.0)) {
                clipped_.push_back(previous + (before / (before - here)) * (p - previous));
            }
            if (here >= 0.0) {
                clipped_.push_back(p);
            }
            previous = p;
            before = here;
        }
        std::swap(polygon_, clipped_);
        return true;
    };
    return planes.for_each(keep);
}

}  // namespace earshot::frustum
