// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/visible_facets.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

namespace {

/// Room for rounding in (u, v), in cells, beyond what follows from a polygon's distance.
constexpr double kCellSlack = 0x1p-30;

/// Polygons are cut off this far outside the grid, in cells, and by as much as their points may be
/// off; the cut must not mark a cell.
constexpr double kClipMargin = 1.0;

/// How far a point moves across (forward + u right), in metres per metre that it is off, and how
/// far in u at depth 1: at most 1 + |u|, |u| <= 1 in the grid. Twice that, because outlines are
/// moved along a coordinate axis, up to sqrt(3) times as far as their distance from the plane.
constexpr double kSpread = 4.0;

/// Relative room for rounding in inverse depths, which are sums of three products.
constexpr double kDepthSlack = 0x1p-40;

/// A facet whose depth is known worse than this is not trusted to hide anything.
constexpr double kGrazingCover = 0x1p-6;

InverseDepth scaled(const InverseDepth& depth, double factor) noexcept {
    return {.constant = factor * depth.constant, .slope = factor * depth.slope};
}

/// Whether a is nearer than b everywhere in the rectangle, by more than rounding.
bool nearer_throughout(const InverseDepth& a, const InverseDepth& b, const Rect& rect) noexcept {
    const InverseDepth difference = {.constant = a.constant - b.constant,
                                     .slope = a.slope - b.slope};
    const double size = std::abs(a.constant) + std::abs(b.constant) + std::abs(a.slope.x) +
                        std::abs(a.slope.y) + std::abs(b.slope.x) + std::abs(b.slope.y);
    return difference.least(rect) > kDepthSlack * size;
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

VisibleFacets::VisibleFacets(const FacetIndex& index,
                             Mode mode,
                             double contact_reach,
                             double listener_reach)
    : index_(index),
      mode_(mode),
      contact_reach_(contact_reach),
      listener_reach_(listener_reach),
      raster_(Rect{}, 1) {}

void VisibleFacets::enter(const Frustum& frustum) {
    frustum_ = frustum;
    raster_ = CellRaster(frustum.rect, frustum.cells);
    moved_ = kRounding * (index_.scale() + listener_reach_ + glm::length(frustum.apex));
    covered_ = 0;
    candidates_.clear();
    found_.clear();
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
    // In the plane of its apex a facet neither reflects (PathVerifier::grazing_distance is at least
    // this) nor fills a sub-frustum.
    const double height = index_.plane(facet).distance(frustum_.apex);
    if (std::abs(height) <= kRounding * index_.scale()) {
        return;
    }
    Projected projected;
    if (!draw(frustum_, raster_, facet, projected)) {
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

// Draws a facet as seen from the frustum's apex, beyond the facet where the frustum starts.
// Returns false if nothing of it is inside.
bool VisibleFacets::draw(const Frustum& frustum,
                         CellRaster& raster,
                         FacetId facet,
                         Projected& out) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double moved = moved_ + index_.flatness(facet);
    out.bounds = {.lower = glm::dvec2(kInfinity), .upper = glm::dvec2(-kInfinity)};
    double least_depth = kInfinity;
    outline_.clear();
    std::array<std::size_t, 16> few_ends{};
    std::vector<std::size_t> many_ends;
    const auto loops = index_.loops(facet);
    if (loops.size() > few_ends.size()) {
        many_ends.resize(loops.size());
    }
    const std::span<std::size_t> ends =
        many_ends.empty() ? std::span(few_ends) : std::span(many_ends);
    for (std::size_t i = 0; i < loops.size(); ++i) {
        polygon_.clear();
        for (std::uint32_t v = loops[i].begin; v < loops[i].end; ++v) {
            polygon_.push_back(frustum.local(index_.vertices()[v]));
        }
        if (clip(frustum, raster, moved)) {
            for (const Vec3& p : polygon_) {
                least_depth = std::min(least_depth, p.z);
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
    if (least_depth < kSpread * moved) {
        // Closer to the apex than its points are known: it may be seen in any direction.
        const CellMask all = raster.cells_of(frustum.rect, 0.0);
        out.coverage = {.touched = all, .filled = 0, .centred = all};
        out.bounds = {.lower = frustum.rect.lower - cell, .upper = frustum.rect.upper + cell};
        return true;
    }
    const double slack_uv = kSpread * moved / least_depth;
    const double slack = kCellSlack + slack_uv / std::min(cell.x, cell.y);
    raster.start(slack);
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

// Sutherland and Hodgman 1974, against the start plane and the four sides of the grid grown by a
// margin, all moved outward by what the polygon's points may be off (`moved`, metres).
bool VisibleFacets::clip(const Frustum& frustum, const CellRaster& raster, double moved) {
    const double reach = kSpread * moved;
    const glm::dvec2 margin = kClipMargin * raster.cell_size();
    const glm::dvec2 lower = frustum.rect.lower - margin;
    const glm::dvec2 upper = frustum.rect.upper + margin;
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
    if (frustum.starts_at_facet) {
        // 1 - depth * start(u, v) > 0 behind the start plane, up to the positive factor of its
        // distance from the apex: points on the plane stay.
        const InverseDepth& start = frustum.start;
        const double slack = moved / std::abs(index_.plane(frustum.facet).distance(frustum.apex));
        if (!keep([&](const Vec3& p) {
                return start.constant * p.z + start.slope.x * p.x + start.slope.y * p.y - 1.0 +
                       slack;
            })) {
            return false;
        }
    }
    return keep([&](const Vec3& p) { return p.z - frustum.least_depth + moved; }) &&
           keep([&](const Vec3& p) { return p.x - lower.x * p.z + reach; }) &&
           keep([&](const Vec3& p) { return upper.x * p.z - p.x + reach; }) &&
           keep([&](const Vec3& p) { return p.y - lower.y * p.z + reach; }) &&
           keep([&](const Vec3& p) { return upper.y * p.z - p.y + reach; });
}

void VisibleFacets::add_cover(FacetId facet, const InverseDepth& depth, CellMask filled) {
    if (filled == 0) {
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
    for_each_cell(filled, [&](int cell) {
        const Rect rect = raster_.cell_rect(cell / kGridSide, cell % kGridSide);
        if (frustum_.starts_at_facet &&
            !nearer_throughout(start_limit_, scaled(depth, 1.0 + error), rect)) {
            return;
        }
        Cover& cover = covers_[static_cast<std::size_t>(cell)];
        const double centre = back.at(0.5 * (rect.lower + rect.upper));
        const CellMask bit = CellMask{1} << cell;
        if ((covered_ & bit) == 0 || centre > cover.centre) {
            cover = {facet, back, centre};
            covered_ |= bit;
        }
    });
}

void VisibleFacets::add_sample(FacetId facet, const InverseDepth& depth, CellMask centred) {
    for_each_cell(centred, [&](int cell) {
        const Rect rect = raster_.cell_rect(cell / kGridSide, cell % kGridSide);
        Cover& cover = covers_[static_cast<std::size_t>(cell)];
        const double centre = depth.at(0.5 * (rect.lower + rect.upper));
        const CellMask bit = CellMask{1} << cell;
        if ((covered_ & bit) == 0 || centre > cover.centre) {
            cover = {facet, depth, centre};
            covered_ |= bit;
        }
    });
}

// A box is hidden if every sub-frustum it may meet is filled by something nearer than its nearest
// corner.
bool VisibleFacets::box_is_hidden(const geometry::Aabb& box) const noexcept {
    if (covered_ == 0 || mode_ == Mode::sampled) {
        return false;
    }
    Rect bounds = {.lower = glm::dvec2(std::numeric_limits<double>::infinity()),
                   .upper = glm::dvec2(-std::numeric_limits<double>::infinity())};
    double nearest = std::numeric_limits<double>::infinity();
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3 point = {static_cast<double>((corner & 1U) != 0 ? box.upper[0] : box.lower[0]),
                            static_cast<double>((corner & 2U) != 0 ? box.upper[1] : box.lower[1]),
                            static_cast<double>((corner & 4U) != 0 ? box.upper[2] : box.lower[2])};
        const Vec3 p = frustum_.local(point);
        if (!(p.z > frustum_.least_depth)) {
            return false;
        }
        const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
        bounds.lower = glm::min(bounds.lower, uv);
        bounds.upper = glm::max(bounds.upper, uv);
        nearest = std::min(nearest, p.z);
    }
    const CellMask cells = cells_near(bounds, nearest);
    return (cells & ~covered_) == 0 && everything_hides(nearest, cells);
}

CellMask VisibleFacets::hidden_cells(FacetId facet,
                                     const InverseDepth& depth,
                                     CellMask cells) const noexcept {
    CellMask hidden = 0;
    for_each_cell(cells & covered_, [&](int cell) {
        const Cover& cover = covers_[static_cast<std::size_t>(cell)];
        const Rect rect = raster_.cell_rect(cell / kGridSide, cell % kGridSide);
        if (cover.facet != facet && nearer_throughout(cover.depth, depth, rect)) {
            hidden |= CellMask{1} << cell;
        }
    });
    return hidden;
}

void VisibleFacets::collect_found() {
    for (const Candidate& candidate : candidates_) {
        CellMask cells = candidate.touched;
        if (mode_ == Mode::sampled) {
            CellMask won = 0;
            for_each_cell(covered_ & cells, [&](int cell) {
                won |= static_cast<CellMask>(covers_[static_cast<std::size_t>(cell)].facet ==
                                             candidate.facet)
                       << cell;
            });
            cells = won;
        } else {
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
        const Rect rect = raster_.cell_rect(cell / kGridSide, cell % kGridSide);
        if ((covered_ >> cell & 1) == 0 ||
            !nearer_throughout(covers_[static_cast<std::size_t>(cell)].depth, front, rect)) {
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
    // The straight line from the apex to the mirrored point passes the facet where the sound
    // reflects.
    const Vec3 p = frustum_.local(plane.mirror(point));
    if (!(p.z > frustum_.least_depth)) {
        return false;
    }
    const glm::dvec2 uv = {p.x / p.z, p.y / p.z};
    return (cells_near({.lower = uv, .upper = uv}, p.z) & visible.cells) != 0;
}

Frustum VisibleFacets::reflect(const VisibleFacet& visible) {
    Frustum child = mirrored(frustum_, index_.plane(visible.facet), visible.facet, visible.window);
    CellRaster raster(child.rect, child.cells);
    Projected own;
    // The facet itself, drawn from the parent's side: (u, v) is the same for both.
    Frustum aperture = frustum_;
    aperture.rect = child.rect;
    child.alive = draw(aperture, raster, visible.facet, own) ? own.coverage.touched : 0;
    const glm::dvec2 size = raster_.cell_size();
    const double slack = kCellSlack + kWindowSlack / std::min(size.x, size.y);
    child.alive &= raster.cells_meeting(raster_, visible.cells, slack);
    return child;
}

}  // namespace earshot::frustum
