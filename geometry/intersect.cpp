// SPDX-License-Identifier: MIT
#include "earshot/geometry/intersect.h"

#include "earshot/geometry/internal/projection.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace earshot::geometry {
namespace {

// Of the coordinates involved, in units of 2^-53 of which: moving and shearing a vertex is off by
// some 10, an edge function by 2 of the distances to its ends, which in a triangle that is hit are
// no longer than its edges, and a distance to a side of a box by 3, with those below. The rest of
// the padding is there for lies_in_own_box().
constexpr double kPad = 0x1p-38;

// The inverse of a component that is zero or nearly so. Finite, so that its product with 0 is 0,
// and so large that any other product lies beyond the distances along the other axes.
constexpr double kMaxInverse = 0x1p1023;

/// An axis along which the triangle does not project to a line.
int open_axis(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    for (int axis = 0; axis < 2; ++axis) {
        if (orient2d(project_along(a, axis), project_along(b, axis), project_along(c, axis)) != 0) {
            return axis;
        }
    }
    return 2;
}

bool all_on_one_side(int u, int v, int w) noexcept {
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

using Triangle2d = std::array<glm::dvec2, 3>;

bool contains(const Triangle2d& t, const glm::dvec2& p) noexcept {
    return all_on_one_side(
        orient2d(t[0], t[1], p), orient2d(t[1], t[2], p), orient2d(t[2], t[0], p));
}

/// Whether two closed segments share a point, unless an end of one lies in the other along one line
/// (which the callers find by contains()).
bool cross(const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& a, const glm::dvec2& b) {
    const int ap = orient2d(p, q, a);
    const int bp = orient2d(p, q, b);
    const int pa = orient2d(a, b, p);
    const int qa = orient2d(a, b, q);
    const bool collinear = ap == 0 && bp == 0;
    return !collinear && ap * bp <= 0 && pa * qa <= 0;
}

bool touches_in_plane(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int axis = open_axis(a, b, c);
    const glm::dvec2 p = project_along(segment.from, axis);
    const glm::dvec2 q = project_along(segment.to, axis);
    const Triangle2d t = {project_along(a, axis), project_along(b, axis), project_along(c, axis)};
    // A segment that runs along an edge and has neither end in the triangle covers the whole edge,
    // and so crosses the other two at their ends.
    return contains(t, p) || contains(t, q) || cross(p, q, t[0], t[1]) || cross(p, q, t[1], t[2]) ||
           cross(p, q, t[2], t[0]);
}

/// Where a value that changes sign along a segment, or reaches 0 at one end, does so.
double crossing(double from, double to) noexcept {
    return from / (from - to) + 0.0;  // not -0
}

/// Where a segment that touches a triangle in its plane does so first: clipped by the three edges
/// in turn.
double entry_in_plane(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int axis = open_axis(a, b, c);
    const glm::dvec2 p = project_along(segment.from, axis);
    const glm::dvec2 q = project_along(segment.to, axis);
    const Triangle2d t = {project_along(a, axis), project_along(b, axis), project_along(c, axis)};
    const double orientation = orient2d(t[0], t[1], t[2]);
    double entry = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double from = orientation * determinant2d(t[i], t[(i + 1) % 3], p);
        if (from < 0.0) {
            // The far end is not outside too, or the segment would not touch.
            const double to = orientation * determinant2d(t[i], t[(i + 1) % 3], q);
            entry = std::max(entry, crossing(from, to));
        }
    }
    return entry;
}

}  // namespace

SlabTest::SlabTest(const Vec3& origin, const Vec3& direction, double max_abs_coordinate) noexcept {
    const double pad = kPad * (max_abs(origin) + max_abs_coordinate);
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        inverse_[k] = std::clamp(1.0 / direction[axis], -kMaxInverse, kMaxInverse);
        is_forward_[k] = inverse_[k] > 0.0;
        before_[k] = origin[axis] + (is_forward_[k] ? pad : -pad);
        after_[k] = origin[axis] - (is_forward_[k] ? pad : -pad);
    }
}

namespace {

/// round_down(), without branches that depend on the last bits of a coordinate: every second would
/// be mispredicted.
float round_down_branchless(double value) noexcept {
    constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());
    if (!(std::abs(value) < kLargest)) {
        return round_down(value);
    }
    const auto nearest = static_cast<float>(value);
    const auto bits = std::bit_cast<std::int32_t>(nearest);
    // The next float below: of positive ones the bits count up, of negative ones down, and 0 has
    // the least negative one below it.
    constexpr std::int32_t kLeastNegative = std::numeric_limits<std::int32_t>::min() + 1;
    const std::int32_t below = bits > 0 ? bits - 1 : nearest == 0.0F ? kLeastNegative : bits + 1;
    const std::int32_t is_above = static_cast<double>(nearest) > value ? -1 : 0;
    return std::bit_cast<float>((bits & ~is_above) | (below & is_above));
}

}  // namespace

Aabb triangle_box(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        box.lower[k] = round_down_branchless(std::min(std::min(a[axis], b[axis]), c[axis]));
        box.upper[k] = -round_down_branchless(-std::max(std::max(a[axis], b[axis]), c[axis]));
    }
    return box;
}

bool touches(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    const int from = orient3d(a, b, c, segment.from);
    const int to = orient3d(a, b, c, segment.to);
    if (from == to) {
        // Any point is coplanar with a triangle without area, which touches nothing.
        return from == 0 && has_area(a, b, c) && touches_in_plane(segment, a, b, c);
    }
    // The line crosses the plane in one point, which lies in the triangle if the line passes its
    // three edges on one side (Pluecker).
    return all_on_one_side(orient3d(segment.from, segment.to, a, b),
                           orient3d(segment.from, segment.to, b, c),
                           orient3d(segment.from, segment.to, c, a));
}

std::optional<double> first_touch(const Segment& segment,
                                  const Vec3& a,
                                  const Vec3& b,
                                  const Vec3& c) noexcept {
    if (!touches(segment, a, b, c)) {
        return std::nullopt;
    }
    const double from = determinant3d(a, b, c, segment.from);
    const double to = determinant3d(a, b, c, segment.to);
    return from == to ? entry_in_plane(segment, a, b, c) : crossing(from, to);
}

}  // namespace earshot::geometry
