// SPDX-License-Identifier: MIT
#include "earshot/geometry/overlap.h"

#include "earshot/base/error.h"
#include "earshot/geometry/internal/projection.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace earshot::geometry {
namespace {

bool is_inside(const Vec3& point, const Vec3& lower, const Vec3& upper) noexcept {
    return point.x >= lower.x && point.x <= upper.x && point.y >= lower.y && point.y <= upper.y &&
           point.z >= lower.z && point.z <= upper.z;
}

/// Whether the triangle's plane leaves all corners of a box on one side.
bool plane_parts(
    const Vec3& lower, const Vec3& upper, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    int side = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3 point((corner & 1U) != 0 ? upper.x : lower.x,
                         (corner & 2U) != 0 ? upper.y : lower.y,
                         (corner & 4U) != 0 ? upper.z : lower.z);
        const int here = orient3d(a, b, c, point);
        if (here == 0 || here * side < 0) {
            return false;
        }
        side = here;
    }
    return true;
}

/// Whether the line through a and b parts the triangle from the rectangle, in two dimensions.
bool line_parts(const glm::dvec2& lower,
                const glm::dvec2& upper,
                const glm::dvec2& a,
                const glm::dvec2& b,
                const glm::dvec2& c) noexcept {
    // The rectangle must lie on the other side than c, or on any if c lies on the line too.
    int side = -orient2d(a, b, c);
    for (const glm::dvec2& corner :
         {lower, glm::dvec2(upper.x, lower.y), glm::dvec2(lower.x, upper.y), upper}) {
        const int here = orient2d(a, b, corner);
        if (here == 0 || here * side < 0) {
            return false;
        }
        side = here;
    }
    return true;
}

// The value is monotone in each coordinate, in floating point too.
double signed_distance(const Plane& plane, const Vec3& point) noexcept {
    return ((plane.normal.x * point.x + plane.normal.y * point.y) + plane.normal.z * point.z) -
           plane.offset;
}

/// A convex polygon that planes cut.
struct Polygon {
    std::array<Vec3, ConvexRegion::kMaxPlanes + 3> corners;
    std::size_t count = 0;

    /// Keeps what lies on or behind the plane; false if that is nothing.
    bool clip(const Plane& plane) noexcept {
        std::array<double, ConvexRegion::kMaxPlanes + 3> distance{};
        std::size_t deepest = 0;
        for (std::size_t i = 0; i < count; ++i) {
            distance[i] = signed_distance(plane, corners[i]);
            deepest = distance[i] < distance[deepest] ? i : deepest;
        }
        if (distance[deepest] > 0.0) {
            return false;
        }
        // The corners kept are one run around the deepest, even where rounding has dented the
        // polygon: so a cut adds one corner at most.
        std::size_t ahead = 0;
        while (ahead < count && distance[(deepest + ahead) % count] <= 0.0) {
            ++ahead;
        }
        if (ahead == count) {
            return true;
        }
        std::size_t behind = 0;
        while (distance[(deepest + count - behind - 1) % count] <= 0.0) {
            ++behind;
        }
        const auto crossing = [&](std::size_t in, std::size_t out) {
            const double fraction = distance[in] / (distance[in] - distance[out]);
            return corners[in] + fraction * (corners[out] - corners[in]);
        };
        const std::size_t first = (deepest + count - behind) % count;
        const std::size_t last = (deepest + ahead - 1) % count;
        Polygon kept;
        kept.corners[kept.count++] = crossing(first, (first + count - 1) % count);
        for (std::size_t i = 0; i < behind + ahead; ++i) {
            kept.corners[kept.count++] = corners[(first + i) % count];
        }
        kept.corners[kept.count++] = crossing(last, (last + 1) % count);
        *this = kept;
        return true;
    }
};

}  // namespace

bool BoxRegion::may_touch(const Aabb& box) const noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        if (!(lower_[axis] <= static_cast<double>(box.upper[k]) &&
              upper_[axis] >= static_cast<double>(box.lower[k]))) {
            return false;
        }
    }
    return true;
}

// Separating axes (Akenine-Moeller 2001), each decided by exact predicates: the sides of the box,
// the plane of the triangle, and, for the products of their edges, the triangle's sides in the
// three projections along the box's. If the projections are disjoint, a side of one parts them.
bool BoxRegion::touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept {
    // Clipped to the triangle's own bounds, the box is finite.
    Vec3 lower, upper;
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::max(lower_[axis], std::min({a[axis], b[axis], c[axis]}));
        upper[axis] = std::min(upper_[axis], std::max({a[axis], b[axis], c[axis]}));
        if (!(lower_[axis] <= upper_[axis] && lower[axis] <= upper[axis])) {
            return false;
        }
    }
    if (is_inside(a, lower, upper) || is_inside(b, lower, upper) || is_inside(c, lower, upper)) {
        return true;
    }
    if (plane_parts(lower, upper, a, b, c)) {
        return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec2 min = project_along(lower, axis);
        const glm::dvec2 max = project_along(upper, axis);
        const std::array<glm::dvec2, 3> t{
            project_along(a, axis), project_along(b, axis), project_along(c, axis)};
        if (line_parts(min, max, t[0], t[1], t[2]) || line_parts(min, max, t[1], t[2], t[0]) ||
            line_parts(min, max, t[2], t[0], t[1])) {
            return false;
        }
    }
    return true;
}

ConvexRegion::ConvexRegion(std::span<const Plane> planes) : planes_(planes.begin(), planes.end()) {
    if (planes.size() > kMaxPlanes) {
        throw Error("convex region",
                    "cannot have more than " + std::to_string(kMaxPlanes) + " planes");
    }
    is_valid_ = std::all_of(planes.begin(), planes.end(), [](const Plane& plane) {
        return is_finite(plane.normal) && std::isfinite(plane.offset);
    });
}

bool ConvexRegion::may_touch(const Aabb& box) const noexcept {
    // Every vertex in the box is at least as far before the plane as the corner tried here.
    return std::none_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
        Vec3 deepest;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            deepest[axis] =
                static_cast<double>(plane.normal[axis] >= 0.0 ? box.lower[k] : box.upper[k]);
        }
        return signed_distance(plane, deepest) > 0.0;
    });
}

bool ConvexRegion::touches(const Vec3& a, const Vec3& b, const Vec3& c) const noexcept {
    const auto is_before = [&](const Plane& plane) {
        return signed_distance(plane, a) > 0.0 && signed_distance(plane, b) > 0.0 &&
               signed_distance(plane, c) > 0.0;
    };
    if (!is_valid_ || std::any_of(planes_.begin(), planes_.end(), is_before)) {
        return false;
    }
    // Sutherland and Hodgman 1974.
    Polygon polygon{.corners = {a, b, c}, .count = 3};
    return std::all_of(
        planes_.begin(), planes_.end(), [&](const Plane& plane) { return polygon.clip(plane); });
}

}  // namespace earshot::geometry
