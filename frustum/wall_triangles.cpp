// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/wall_triangles.h"

#include "earshot/frustum/internal/containment.h"
#include "earshot/frustum/internal/facet_index.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::frustum {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kMinSide = 8, kMaxSide = 256;
/// Cells are taken to be this much larger, as a share of their size: far above rounding.
constexpr double kMargin = 0x1p-10;

/// How far a rectangle reaches to the left of a directed line, times the line's length: the lowest
/// and the highest value of its corners.
struct Reach {
    double low = 0.0, high = 0.0;
};

Reach reach_left_of(const glm::dvec2& from,
                    const glm::dvec2& to,
                    const glm::dvec2& lower,
                    const glm::dvec2& upper) noexcept {
    const glm::dvec2 left = {from.y - to.y, to.x - from.x};
    const glm::dvec2 a = left * (lower - from);
    const glm::dvec2 b = left * (upper - from);
    return {std::min(a.x, b.x) + std::min(a.y, b.y), std::max(a.x, b.x) + std::max(a.y, b.y)};
}

}  // namespace

WallTriangles::WallTriangles(const SceneView& scene, geometry::FacetId facet)
    : axis_(dominant_axis(scene.facets.facets[facet].plane.normal)) {
    glm::dvec2 upper(0.0);
    for (const TriangleId id : scene.facets.facets[facet].triangles) {
        Candidate candidate{.triangle = id, .corner = {}};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 corner = project(scene.bvh.corners(id)[k], axis_);
            const bool is_first = triangles_.empty() && k == 0;
            lower_ = is_first ? corner : glm::min(lower_, corner);
            upper = is_first ? corner : glm::max(upper, corner);
            candidate.corner[k] = corner;
        }
        triangles_.push_back(candidate);
    }
    const auto wished = static_cast<std::size_t>(2.0 * std::sqrt(triangles_.size()));
    side_ = std::clamp(wished, kMinSide, kMaxSide);
    cell_size_ = (upper - lower_) / static_cast<double>(side_);
    cells_per_metre_ = 1.0 / cell_size_;
    cells_.resize(side_ * side_);

    std::vector<std::vector<std::uint32_t>> lists(cells_.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        add_to_cells(static_cast<std::uint32_t>(i), lists);
    }
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        cells_[i].begin = static_cast<std::uint32_t>(listed_.size());
        cells_[i].count = static_cast<std::uint32_t>(lists[i].size());
        listed_.insert(listed_.end(), lists[i].begin(), lists[i].end());
        const auto [lower, higher] = rectangle(i);
        cells_[i].is_covered =
            lists[i].size() == 1 && covers(triangles_[lists[i].front()], lower, higher);
    }
}

std::size_t WallTriangles::coordinate(double position, int axis) const noexcept {
    const double cell = (position - lower_[axis]) * cells_per_metre_[axis];
    // Also where a point lies beside the wall, or the wall has no width.
    return cell > 0.0 ? std::min(static_cast<std::size_t>(cell), side_ - 1) : 0;
}

WallTriangles::Rectangle WallTriangles::rectangle(std::size_t cell) const noexcept {
    const glm::dvec2 corner(static_cast<double>(cell % side_), static_cast<double>(cell / side_));
    return {lower_ + (corner - kMargin) * cell_size_,
            lower_ + (corner + 1.0 + kMargin) * cell_size_};
}

void WallTriangles::add_to_cells(std::uint32_t index,
                                 std::vector<std::vector<std::uint32_t>>& lists) const {
    const Candidate& candidate = triangles_[index];
    const auto& [a, b, c] = candidate.corner;
    const glm::dvec2 margin = kMargin * cell_size_;
    const glm::dvec2 lower = glm::min(glm::min(a, b), c) - margin;
    const glm::dvec2 upper = glm::max(glm::max(a, b), c) + margin;
    for (std::size_t y = coordinate(lower.y, 1); y <= coordinate(upper.y, 1); ++y) {
        for (std::size_t x = coordinate(lower.x, 0); x <= coordinate(upper.x, 0); ++x) {
            const std::size_t cell = y * side_ + x;
            const auto [low, high] = rectangle(cell);
            if (may_touch(candidate, low, high)) {
                lists[cell].push_back(index);
            }
        }
    }
}

// Separating axes: a rectangle that lies wholly beside one edge does not touch the triangle. The
// boxes overlap already.
bool WallTriangles::may_touch(const Candidate& candidate,
                              const glm::dvec2& lower,
                              const glm::dvec2& upper) noexcept {
    bool all_left = true, all_right = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const Reach reach =
            reach_left_of(candidate.corner[k], candidate.corner[(k + 1) % 3], lower, upper);
        all_left = all_left && reach.high >= 0.0;
        all_right = all_right && reach.low <= 0.0;
    }
    return all_left || all_right;
}

bool WallTriangles::covers(const Candidate& candidate,
                           const glm::dvec2& lower,
                           const glm::dvec2& upper) noexcept {
    bool all_left = true, all_right = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const Reach reach =
            reach_left_of(candidate.corner[k], candidate.corner[(k + 1) % 3], lower, upper);
        all_left = all_left && reach.low > 0.0;
        all_right = all_right && reach.high < 0.0;
    }
    return all_left || all_right;
}

std::optional<TriangleId> WallTriangles::at(const Vec3& point) const {
    const glm::dvec2 p = project(point, axis_);
    const Cell& cell = cells_[coordinate(p.y, 1) * side_ + coordinate(p.x, 0)];
    if (cell.is_covered) {
        return triangles_[listed_[cell.begin]].triangle;
    }
    for (std::uint32_t i = cell.begin; i < cell.begin + cell.count; ++i) {
        const Candidate& candidate = triangles_[listed_[i]];
        if (is_inside(p, candidate.corner)) {
            return candidate.triangle;
        }
    }
    return std::nullopt;
}

}  // namespace earshot::frustum
