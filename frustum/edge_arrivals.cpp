// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/visible_facets.h"

#include <glm/common.hpp>

#include <algorithm>

namespace earshot::frustum {

using geometry::Vec3;

namespace {

/// The part of a line on which linear functions are at least 0.
struct ClippedLine {
    double begin = 0.0, end = 1.0;

    /// Of a function with these values at the line's ends.
    void clip(double at_begin, double at_end) noexcept {
        constexpr double kRounding = 0x1p-40;  // of the place of a crossing
        if (at_begin < 0.0 && at_end < 0.0) {
            end = -1.0;
        } else if (at_begin < 0.0) {
            begin = std::max(begin, at_begin / (at_begin - at_end) - kRounding);
        } else if (at_end < 0.0) {
            end = std::min(end, at_begin / (at_begin - at_end) + kRounding);
        }
    }
};

}  // namespace

// The line is cut to the frustum, grown by the errors with which may_arrive_at() reckons. The
// bounds of what is left tell the sub-frusta, as those of one point do.
bool VisibleFacets::may_arrive_on(const Vec3& begin, const Vec3& end) const noexcept {
    if (frustum_.starts_at_facet) {
        const geometry::Plane& plane = index_.plane(frustum_.facet);
        if (std::max(frustum_.side * plane.distance(begin), frustum_.side * plane.distance(end)) <
            -position_error_) {
            return false;
        }
    }
    const Vec3 a = frustum_.local(begin);
    const Vec3 b = frustum_.local(end);
    const Rect& rect = frustum_.rect;
    ClippedLine line;
    line.clip(a.z - frustum_.min_depth, b.z - frustum_.min_depth);
    const double error = 2.0 * kProjectionErrorFactor * position_error_;
    for (int k = 0; k < 2; ++k) {
        line.clip(a[k] - rect.lower[k] * a.z + error, b[k] - rect.lower[k] * b.z + error);
        line.clip(rect.upper[k] * a.z - a[k] + error, rect.upper[k] * b.z - b[k] + error);
    }
    if (!(line.begin <= line.end)) {
        return false;
    }
    const Vec3 first = a + line.begin * (b - a);
    const Vec3 last = a + line.end * (b - a);
    const double first_depth = std::max(first.z, frustum_.min_depth);
    const double last_depth = std::max(last.z, frustum_.min_depth);
    const glm::dvec2 from = glm::dvec2(first.x, first.y) / first_depth;
    const glm::dvec2 to = glm::dvec2(last.x, last.y) / last_depth;
    const double depth = std::min(first_depth, last_depth);
    const CellMask cells =
        cells_overlapping({.lower = glm::min(from, to), .upper = glm::max(from, to)}, depth);
    if (cells == 0 || mode_ == Mode::sampled) {
        return cells != 0;
    }
    return !all_occlude_depth(depth, cells);
}

}  // namespace earshot::frustum
