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

OutlineView VisibleFacets::outline_view(const Frustum& frustum,
                                        const CoverageRaster& raster) const noexcept {
    OutlineView view{};
    const Vec3* axes[] = {&frustum.right, &frustum.up, &frustum.forward};
    for (int k = 0; k < 3; ++k) {
        view.apex[k] = frustum.apex[k];
        for (int axis = 0; axis < 3; ++axis) {
            view.axes[axis][k] = (*axes[axis])[k];
        }
    }
    // 1 - depth * start(u, v) > 0 behind the start plane, up to the positive factor of its distance
    // from the apex: points on the plane stay.
    if (frustum.starts_at_facet) {
        view.start_constant = frustum.start.constant;
        view.start_offset = -1.0;
        view.start_slack_per_error =
            1.0 / std::abs(height_above(index_.plane(frustum.facet), frustum.apex));
    }
    const glm::dvec2 margin = kClipMargin * raster.cell_size();
    for (int k = 0; k < 2; ++k) {
        view.start_slope[k] = frustum.starts_at_facet ? frustum.start.slope[k] : 0.0;
        view.lower[k] = frustum.rect.lower[k] - margin[k];
        view.upper[k] = frustum.rect.upper[k] + margin[k];
    }
    view.min_depth = frustum.min_depth;
    return view;
}

/// The half-spaces of an outline view, for points along its axes.
struct VisibleFacets::ClipPlanes {
    ClipPlanes(const OutlineView& the_view, double the_position_error) noexcept
        : view(the_view),
          position_error(the_position_error),
          start_slack(the_position_error * the_view.start_slack_per_error),
          side_error(kProjectionErrorFactor * the_position_error) {}

    /// Calls visit(distance) for each half-space of a set (bits as in OutlineBounds::crossed) in
    /// turn while it returns true; points inside have a distance that is not negative. Returns
    /// whether all did.
    template <typename Visit>
    bool for_each(std::uint32_t half_spaces, Visit&& visit) const {
        const auto passes = [&](int k, auto&& distance) {
            return (half_spaces >> k & 1U) == 0 || visit(distance);
        };
        const auto *const lower = view.lower, *const upper = view.upper;
        return passes(0, [&](const Vec3& p) { return behind_start(p); }) &&
               passes(1, [&](const Vec3& p) { return p.z - view.min_depth + position_error; }) &&
               passes(2, [&](const Vec3& p) { return p.x - lower[0] * p.z + side_error; }) &&
               passes(3, [&](const Vec3& p) { return upper[0] * p.z - p.x + side_error; }) &&
               passes(4, [&](const Vec3& p) { return p.y - lower[1] * p.z + side_error; }) &&
               passes(5, [&](const Vec3& p) { return upper[1] * p.z - p.y + side_error; });
    }

    double behind_start(const Vec3& p) const noexcept {
        return view.start_constant * p.z + view.start_slope[0] * p.x + view.start_slope[1] * p.y +
               view.start_offset + start_slack;
    }
    Vec3 local(const Vec3& point) const noexcept {
        const Vec3 offset = {
            point.x - view.apex[0], point.y - view.apex[1], point.z - view.apex[2]};
        const auto along = [&](const double* axis) {
            return offset.x * axis[0] + offset.y * axis[1] + offset.z * axis[2];
        };
        return {along(view.axes[0]), along(view.axes[1]), along(view.axes[2])};
    }

    const OutlineView& view;
    double position_error, start_slack, side_error;
};

// Draws a facet that lies wholly in the half-space of the frustum's depths, as most do, without
// clipping. If its bounds overlap a few cells only and it is too narrow to cover one, all of these
// are its outer cells and it has no inner one.
VisibleFacets::DrawResult VisibleFacets::draw_whole(const OutlineView& view,
                                                    const Rect& rect,
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
    switch (view_outline(view,
                         position_error,
                         kProjectionErrorFactor,
                         are_few ? &four.front().x : &vertices.front().x,
                         outline_.size(),
                         &outline_.front().x,
                         seen)) {
        case OutlineSeen::not_at_all:
            return DrawResult::outside;
        case OutlineSeen::partly:
            out.crossed = seen.crossed;
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
    if (glm::any(glm::lessThan(lower, rect.lower - far)) ||
        glm::any(glm::greaterThan(upper, rect.upper + far))) {
        out.crossed = kAllHalfSpaces;
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
bool VisibleFacets::draw(const OutlineView& view,
                         const Rect& rect,
                         CoverageRaster& raster,
                         FacetId facet,
                         bool centres_only,
                         Projected& out) {
    const double position_error = position_error_ + index_.flatness(facet);
    switch (draw_whole(view, rect, raster, facet, position_error, centres_only, out)) {
        case DrawResult::outside:
            return false;
        case DrawResult::done:
            return true;
        case DrawResult::needs_clipping:
            break;
    }
    return draw_clipped(view, rect, raster, facet, position_error, centres_only, out);
}

bool VisibleFacets::draw_clipped(const OutlineView& view,
                                 const Rect& rect,
                                 CoverageRaster& raster,
                                 FacetId facet,
                                 double position_error,
                                 bool centres_only,
                                 Projected& out) {
    const ClipPlanes planes(view, position_error);
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
        const auto vertices =
            index_.vertices().subspan(loops[i].begin, loops[i].end - loops[i].begin);
        // What is clipped to the depths seldom extends so far beside the grid that it needs more.
        auto polygon = clip(planes, out.crossed & kDepthHalfSpaces, local(planes, vertices));
        if (!is_near(planes, rect, raster, polygon)) {
            polygon = clip(planes, out.crossed & ~kDepthHalfSpaces, polygon);
        }
        std::size_t end = outline_.size();
        outline_.resize(end + polygon.size());
        for (const Vec3& p : polygon) {
            const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
            min_depth = std::min(min_depth, p.z);
            out.bounds.lower = glm::min(out.bounds.lower, uv);
            out.bounds.upper = glm::max(out.bounds.upper, uv);
            outline_[end++] = uv;
        }
        ends[i] = end;
    }
    if (outline_.empty()) {
        return false;
    }
    const glm::dvec2 cell = raster.cell_size();
    if (min_depth < kProjectionErrorFactor * position_error) {
        // Closer to the apex than its position error: it may be visible in any direction.
        const CellMask all = raster.cells_overlapping(rect, 0.0);
        out.coverage = {.outer = all, .inner = 0, .centre_sampled = all};
        out.bounds = {.lower = rect.lower - cell, .upper = rect.upper + cell};
        return true;
    }
    const double slack_uv = kProjectionErrorFactor * position_error / min_depth;
    const double slack = kCellSlack + slack_uv / std::min(cell.x, cell.y);
    if (raster.cells_overlapping(out.bounds, slack) == 0) {
        return false;
    }
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

// Vertices along the axes of the view, in `polygon_`.
std::span<const Vec3> VisibleFacets::local(const ClipPlanes& planes,
                                           std::span<const Vec3> vertices) {
    polygon_.resize(std::max(polygon_.size(), vertices.size()));
    std::transform(vertices.begin(), vertices.end(), polygon_.begin(), [&](const Vec3& p) {
        return planes.local(p);
    });
    return std::span(polygon_).first(vertices.size());
}

// Whether the polygon need not be clipped to the sides: see kMaxOutside, and errors hardly move
// directions to it.
bool VisibleFacets::is_near(const ClipPlanes& planes,
                            const Rect& rect,
                            const CoverageRaster& raster,
                            std::span<const Vec3> polygon) const noexcept {
    const glm::dvec2 far = kMaxOutside * raster.cell_size();
    const glm::dvec2 lower = rect.lower - far, upper = rect.upper + far;
    return std::all_of(polygon.begin(), polygon.end(), [&](const Vec3& p) {
        return p.z >= 2.0 * planes.side_error && p.x >= lower.x * p.z && p.x <= upper.x * p.z &&
               p.y >= lower.y * p.z && p.y <= upper.y * p.z;
    });
}

// Sutherland and Hodgman 1974. The polygon is in `polygon_`, and so is what remains of it: at most
// two vertices for each.
std::span<const Vec3> VisibleFacets::clip(const ClipPlanes& planes,
                                          std::uint32_t half_spaces,
                                          std::span<const Vec3> polygon) {
    planes.for_each(half_spaces, [&](auto&& inside_distance) {
        clipped_.resize(std::max(clipped_.size(), 2 * polygon.size()));
        Vec3* end = clipped_.data();
        Vec3 previous = polygon.back();
        double before = inside_distance(previous);
        for (const Vec3& p : polygon) {
            const double here = inside_distance(p);
            if ((before >= 0.0) != (here >= 0.0)) {
                *end++ = previous + (before / (before - here)) * (p - previous);
            }
            if (here >= 0.0) {
                *end++ = p;
            }
            previous = p;
            before = here;
        }
        polygon = {clipped_.data(), end};
        std::swap(polygon_, clipped_);
        return !polygon.empty();
    });
    return polygon;
}

}  // namespace earshot::frustum
