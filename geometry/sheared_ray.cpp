// SPDX-License-Identifier: MIT
#include "earshot/geometry/sheared_ray.h"

#include "earshot/geometry/intersect.h"
#include "earshot/geometry/vector.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::geometry {
namespace {

/// Whether a hit is so clear that its line passes the triangle's padded box, and its t lies inside
/// the interval there, without asking. `size` is the sum of |x| + |y| over the sheared corners,
/// `depth` their range in z, metres. Let R be the coordinates involved: the edge functions are off
/// by less than E = 2.5 * 2^-49 R size, so that at the computed hit the line is off the triangle by
/// less than E size / |determinant| sideways and by 12 E depth / |determinant| + 2^-49 R along.
/// Here that is less than a quarter of the padding (2^-38 R, see SlabTest) in both directions.
bool lies_in_own_box(double size, double depth, double determinant) noexcept {
    return size * std::max(size, 4.0 * depth) <= 64.0 * std::abs(determinant);
}

}  // namespace

ShearedRay::ShearedRay(const Ray& ray) noexcept {
    const double size = max_abs(ray.direction);
    if (!takes(ray, size)) {
        return;
    }
    t_max_ = ray.t_max;
    axes_ = RayAxes::of(std::abs(ray.direction.x), std::abs(ray.direction.y), size);
    origin_ = along(ray.origin);
    direction_ = along(ray.direction);
    shear_ = {direction_.x / direction_.z, direction_.y / direction_.z, 1.0 / direction_.z};
}

Vec3 ShearedRay::along(const Vec3& v) const noexcept {
    const double* values = glm::value_ptr(v);
    return {values[axes_.x], values[axes_.y], values[axes_.z]};
}

std::optional<Hit> ShearedRay::hit(const Vec3& a,
                                   const Vec3& b,
                                   const Vec3& c,
                                   double t_max,
                                   double max_abs_coordinate) const noexcept {
    // Woop, Benthin, Wald 2013, appendix A, without backface culling.
    const Vec3 corner_a = along(a);
    const Vec3 corner_b = along(b);
    const Vec3 corner_c = along(c);
    const double az = corner_a.z - origin_.z;
    const double bz = corner_b.z - origin_.z;
    const double cz = corner_c.z - origin_.z;
    const double ax = corner_a.x - origin_.x - shear_.x * az;
    const double ay = corner_a.y - origin_.y - shear_.y * az;
    const double bx = corner_b.x - origin_.x - shear_.x * bz;
    const double by = corner_b.y - origin_.y - shear_.y * bz;
    const double cx = corner_c.x - origin_.x - shear_.x * cz;
    const double cy = corner_c.y - origin_.y - shear_.y * cz;
    const double u = cx * by - cy * bx;
    const double v = ax * cy - ay * cx;
    const double w = bx * ay - by * ax;
    if (std::min({u, v, w}) < 0.0 && std::max({u, v, w}) > 0.0) {
        return std::nullopt;
    }
    const double determinant = u + v + w;
    if (determinant == 0.0) {
        return std::nullopt;
    }
    double t = shear_.z * (u * az + v * bz + w * cz) / determinant;
    const double size = ((std::abs(ax) + std::abs(ay)) + (std::abs(bx) + std::abs(by))) +
                        (std::abs(cx) + std::abs(cy));
    const double depth = std::max({az, bz, cz}) - std::min({az, bz, cz});
    if (!lies_in_own_box(size, depth, determinant)) {
        const auto moved = move_into_own_box(t, corner_a, corner_b, corner_c, max_abs_coordinate);
        if (!moved) {
            return std::nullopt;
        }
        t = *moved;
    }
    if (!(t >= 0.0 && t <= t_max)) {
        return std::nullopt;
    }
    // Adding 0 turns -0 into 0.
    return Hit{.t = t + 0.0, .u = v / determinant + 0.0, .v = w / determinant + 0.0};
}

/// Empty if the line misses the triangle's box. The corners are along the axes.
std::optional<double> ShearedRay::move_into_own_box(double t,
                                                    const Vec3& a,
                                                    const Vec3& b,
                                                    const Vec3& c,
                                                    double max_abs_coordinate) const noexcept {
    const Interval own =
        SlabTest(origin_, direction_, max_abs_coordinate).interval(triangle_box(a, b, c));
    if (own.is_empty()) {
        return std::nullopt;
    }
    return std::clamp(t, own.min, own.max);
}

}  // namespace earshot::geometry
