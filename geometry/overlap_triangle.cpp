// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/projection.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/overlap.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::geometry {
namespace {

bool has_area(const Corners& t) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (orient2d(project_along(t[0], axis),
                     project_along(t[1], axis),
                     project_along(t[2], axis)) != 0) {
            return true;
        }
    }
    return false;
}

/// What a triangle without area is.
Segment segment_of(Corners t) noexcept {
    std::sort(t.begin(), t.end(), lexicographic_less);
    return {t[0], t[2]};
}

bool intervals_touch(double a, double b, double c, double d) noexcept {
    return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
}

/// Whether closed segments, or points, share a point.
bool touch(const glm::dvec2& p,
           const glm::dvec2& q,
           const glm::dvec2& r,
           const glm::dvec2& s) noexcept {
    return intervals_touch(p.x, q.x, r.x, s.x) && intervals_touch(p.y, q.y, r.y, s.y) &&
           orient2d(p, q, r) * orient2d(p, q, s) <= 0 && orient2d(r, s, p) * orient2d(r, s, q) <= 0;
}

bool touch(const Segment& one, const Segment& other) noexcept {
    if (orient3d(one.from, one.to, other.from, other.to) != 0) {
        return false;
    }
    // They lie in one plane, and some projection keeps apart what is apart in it.
    for (int axis = 0; axis < 3; ++axis) {
        if (!touch(project_along(one.from, axis),
                   project_along(one.to, axis),
                   project_along(other.from, axis),
                   project_along(other.to, axis))) {
            return false;
        }
    }
    return true;
}

/// Whether the plane of one leaves the other on one side.
bool plane_parts(const Corners& one, const Corners& other) noexcept {
    const int side = orient3d(one[0], one[1], one[2], other[0]);
    return side != 0 && orient3d(one[0], one[1], one[2], other[1]) == side &&
           orient3d(one[0], one[1], one[2], other[2]) == side;
}

bool an_edge_touches(const Corners& one, const Corners& other) noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
        if (touches({one[i], one[(i + 1) % 3]}, other[0], other[1], other[2])) {
            return true;
        }
    }
    return false;
}

}  // namespace

TriangleRegion::TriangleRegion(const Vec3& a, const Vec3& b, const Vec3& c) noexcept
    : corners_{a, b, c}, lower_(glm::min(glm::min(a, b), c)), upper_(glm::max(glm::max(a, b), c)) {
    for (const Vec3& corner : corners_) {
        if (!is_finite(corner)) {
            lower_ = upper_ = Vec3(std::numeric_limits<double>::quiet_NaN());
            return;
        }
    }
    has_area_ = has_area(corners_);
}

bool TriangleRegion::may_touch(const Aabb& box) const noexcept {
    return BoxRegion(lower_, upper_).may_touch(box);
}

// Two triangles share a point if and only if an edge of one shares a point with the other: where
// they meet, a border begins or ends.
bool TriangleRegion::touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(lower_[axis] <= std::max({a[axis], b[axis], c[axis]}) &&
              upper_[axis] >= std::min({a[axis], b[axis], c[axis]}))) {
            return false;
        }
    }
    // Without area no plane parts anything.
    const Corners other{a, b, c};
    if (plane_parts(corners_, other) || plane_parts(other, corners_)) {
        return false;
    }
    const bool other_has_area = has_area(other);
    if (has_area_ && other_has_area) {
        return an_edge_touches(corners_, other) || an_edge_touches(other, corners_);
    }
    if (has_area_) {
        return geometry::touches(segment_of(other), corners_[0], corners_[1], corners_[2]);
    }
    const Segment segment = segment_of(corners_);
    return other_has_area ? geometry::touches(segment, a, b, c) : touch(segment, segment_of(other));
}

}  // namespace earshot::geometry
