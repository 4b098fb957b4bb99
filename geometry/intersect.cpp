// SPDX-License-Identifier: MIT
#include "earshot/geometry/intersect.h"

#include "earshot/geometry/predicates.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::geometry {
namespace {

constexpr double kPad = 0x1p-45;

double largest(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

bool is_finite(const Vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::dvec2 drop(const Vec3& point, int axis) noexcept {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

/// An axis along which the triangle does not project to a line.
int open_axis(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    for (int axis = 0; axis < 2; ++axis) {
        if (orient2d(drop(a, axis), drop(b, axis), drop(c, axis)) != 0) {
            return axis;
        }
    }
    return 2;
}

bool all_on_one_side(int u, int v, int w) noexcept {
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

using Corners = std::array<glm::dvec2, 3>;

bool contains(const Corners& t, const glm::dvec2& p) noexcept {
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
    const glm::dvec2 p = drop(segment.from, axis);
    const glm::dvec2 q = drop(segment.to, axis);
    const Corners t = {drop(a, axis), drop(b, axis), drop(c, axis)};
    // A segment that runs along an edge and has neither end in the triangle covers the whole edge,
    // and so crosses the other two at their ends.
    return contains(t, p) || contains(t, q) || cross(p, q, t[0], t[1]) || cross(p, q, t[1], t[2]) ||
           cross(p, q, t[2], t[0]);
}

/// Where a segment in the plane of a triangle enters it: clipped by the three edges in turn.
double entry_in_plane(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int axis = open_axis(a, b, c);
    const glm::dvec2 p = drop(segment.from, axis);
    const glm::dvec2 q = drop(segment.to, axis);
    const Corners t = {drop(a, axis), drop(b, axis), drop(c, axis)};
    const double turn = orient2d(t[0], t[1], t[2]);
    double entry = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 edge = t[(i + 1) % 3] - t[i];
        const glm::dvec2 inward = turn * glm::dvec2(-edge.y, edge.x);
        const double from = glm::dot(inward, p - t[i]);
        const double to = glm::dot(inward, q - t[i]);
        if (from < 0.0 && to > from) {
            entry = std::max(entry, from / (from - to));
        }
    }
    return std::min(entry, 1.0);
}

}  // namespace

Slabs::Slabs(const Vec3& origin, const Vec3& direction, double reach) noexcept
    : origin_(origin), pad_(kPad * (largest(origin) + reach)) {
    for (int axis = 0; axis < 3; ++axis) {
        const double inverse = 1.0 / direction[axis];
        const bool is_flat = !std::isfinite(inverse);
        is_flat_[static_cast<std::size_t>(axis)] = is_flat;
        inverse_[axis] = is_flat ? 0.0 : inverse;
    }
}

PreparedRay::PreparedRay(const Ray& ray, double reach) noexcept
    : slabs_(ray.origin, ray.direction, reach), origin_(ray.origin) {
    const double size = largest(ray.direction);
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || !std::isfinite(1.0 / size) ||
        !(ray.t_max >= 0.0)) {
        return;
    }
    t_max_ = ray.t_max;
    const Vec3& d = ray.direction;
    axis_z_ = std::abs(d.x) == size ? 0 : std::abs(d.y) == size ? 1 : 2;
    axis_x_ = (axis_z_ + 1) % 3;
    axis_y_ = (axis_z_ + 2) % 3;
    shear_ = {d[axis_x_] / d[axis_z_], d[axis_y_] / d[axis_z_], 1.0 / d[axis_z_]};
}

std::optional<Hit> PreparedRay::hit(const Vec3& a,
                                    const Vec3& b,
                                    const Vec3& c,
                                    double most) const noexcept {
    // Woop, Benthin, Wald 2013, appendix A, without backface culling.
    const Vec3 from_a = a - origin_;
    const Vec3 from_b = b - origin_;
    const Vec3 from_c = c - origin_;
    const double ax = from_a[axis_x_] - shear_.x * from_a[axis_z_];
    const double ay = from_a[axis_y_] - shear_.y * from_a[axis_z_];
    const double bx = from_b[axis_x_] - shear_.x * from_b[axis_z_];
    const double by = from_b[axis_y_] - shear_.y * from_b[axis_z_];
    const double cx = from_c[axis_x_] - shear_.x * from_c[axis_z_];
    const double cy = from_c[axis_y_] - shear_.y * from_c[axis_z_];
    const double u = cx * by - cy * bx;
    const double v = ax * cy - ay * cx;
    const double w = bx * ay - by * ax;
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) {
        return std::nullopt;
    }
    const double determinant = u + v + w;
    if (determinant == 0.0) {
        return std::nullopt;
    }
    const auto passed = passage(triangle_box(a, b, c), t_max_);
    if (!passed) {
        return std::nullopt;
    }
    const double depth = u * from_a[axis_z_] + v * from_b[axis_z_] + w * from_c[axis_z_];
    const double t = std::clamp(shear_.z * depth / determinant, passed->near, passed->far);
    if (t > most) {
        return std::nullopt;
    }
    return Hit{.t = t, .u = v / determinant, .v = w / determinant};
}

Aabb triangle_box(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        box.lower[k] = round_down(std::min({a[axis], b[axis], c[axis]}));
        box.upper[k] = round_up(std::max({a[axis], b[axis], c[axis]}));
    }
    return box;
}

bool touches(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    const int from = orient3d(a, b, c, segment.from);
    const int to = orient3d(a, b, c, segment.to);
    if (from == to) {
        return from == 0 && touches_in_plane(segment, a, b, c);
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
    const Vec3 normal = glm::cross(b - a, c - a);
    const double from = glm::dot(normal, segment.from - a);
    const double to = glm::dot(normal, segment.to - a);
    const bool in_plane =
        orient3d(a, b, c, segment.from) == 0 && orient3d(a, b, c, segment.to) == 0;
    if (in_plane || from == to) {
        return entry_in_plane(segment, a, b, c);
    }
    return std::clamp(from / (from - to), 0.0, 1.0);
}

}  // namespace earshot::geometry
