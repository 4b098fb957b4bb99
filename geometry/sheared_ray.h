// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace earshot::geometry {

/// Which axes a ray's directions go by: z is that of its largest component.
struct RayAxes {
    std::size_t x = 1, y = 2, z = 0;

    /// From the components' sizes and the largest of them. Free of branches, which nobody could
    /// foresee.
    template <typename Real>
    static RayAxes of(Real size_x, Real size_y, Real largest) noexcept {
        constexpr std::size_t kNext[] = {1, 2, 0, 1};
        const auto z = static_cast<std::size_t>(static_cast<int>(size_x != largest) *
                                                (1 + static_cast<int>(size_y != largest)));
        return {kNext[z], kNext[z + 1], z};
    }
};

/// A ray prepared for many triangles: the one place where a ray's hits are decided.
///
/// Triangles by the watertight test of Woop, Benthin and Wald 2013, in double precision: vertices
/// are moved and sheared so that the ray runs along an axis, and three edge functions decide. Each
/// depends on its two vertices only and changes sign exactly when they are swapped, and zero counts
/// as inside, so no ray slips between triangles that share an edge. Both sides of a triangle are
/// hit; a triangle seen edge-on is not (its neighbours are).
///
/// hit() also demands that the line passes the triangle's own box and moves t into its interval
/// there, before it asks whether t lies in [0, t_max]. So a search may leave out every box that is
/// not passed, or passed later than a hit already found, and the answer is the same to the last bit
/// with any hierarchy.
class ShearedRay {
public:
    explicit ShearedRay(const Ray& ray) noexcept {
        const Vec3& d = ray.direction;
        const double size = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        if (!takes(ray, size)) {
            return;
        }
        t_max_ = ray.t_max;
        axis_z_ = std::abs(d.x) == size ? 0 : std::abs(d.y) == size ? 1 : 2;
        axis_x_ = axis_z_ == 2 ? 0 : axis_z_ + 1;
        axis_y_ = axis_x_ == 2 ? 0 : axis_x_ + 1;
        origin_ = along(ray.origin);
        direction_ = along(d);
        shear_ = {direction_.x / direction_.z, direction_.y / direction_.z, 1.0 / direction_.z};
    }

    /// Whether a ray may hit anything; `size` is the largest component of its direction.
    static bool takes(const Ray& ray, double size) noexcept {
        const Vec3& d = ray.direction;
        const double sum = (ray.origin.x + ray.origin.y + ray.origin.z) + (d.x + d.y + d.z);
        // A sum is finite only if its terms are; it overflows only where no scene is.
        return sum - sum == 0.0 && size >= kShortest && size <= kLongest && ray.t_max >= 0.0;
    }

    /// False: the ray hits nothing, because a component of origin or direction is not finite (or
    /// their sum is not), the direction's largest component is not within 2^-500 ... 2^500, or
    /// t_max is negative or not a number.
    bool is_valid() const noexcept { return t_max_ >= 0.0; }
    double t_max() const noexcept { return t_max_; }

    /// The ray's hit of a triangle at `t_max` at the farthest. Hit::triangle is left 0.
    /// `max_abs_coordinate` is that of SlabTest.
    std::optional<Hit> hit(const Vec3& a,
                           const Vec3& b,
                           const Vec3& c,
                           double t_max,
                           double max_abs_coordinate) const noexcept;

private:
    // Largest components of directions whose inverses, and distances to single-precision
    // coordinates in multiples of them, neither overflow nor lose bits.
    static constexpr double kShortest = 0x1p-500;
    static constexpr double kLongest = 0x1p500;

    Vec3 along(const Vec3& v) const noexcept {
        const double* values = glm::value_ptr(v);
        return {values[axis_x_], values[axis_y_], values[axis_z_]};
    }

    /// Whether a hit is so clear that its line passes the triangle's padded box, and its t lies
    /// inside the interval there, without asking. `size` is the sum of |x| + |y| over the sheared
    /// corners, `depth` their range in z, metres. Let R be the coordinates involved: the edge
    /// functions are off by less than E = 2.5 * 2^-49 R size, so that at the computed hit the line
    /// is off the triangle by less than E size / |determinant| sideways and by
    /// 12 E depth / |determinant| + 2^-49 R along. Here that is less than a quarter of the padding
    /// (2^-38 R, see SlabTest) in both directions.
    static bool lies_in_own_box(double size, double depth, double determinant) noexcept {
        return size * std::max(size, 4.0 * depth) <= 64.0 * std::abs(determinant);
    }

    /// Empty if the line misses the triangle's box. The corners are along the axes.
    std::optional<double> move_into_own_box(double t,
                                            const Vec3& a,
                                            const Vec3& b,
                                            const Vec3& c,
                                            double max_abs_coordinate) const noexcept;

    double t_max_ = -1.0;
    std::size_t axis_x_ = 0, axis_y_ = 1, axis_z_ = 2;
    Vec3 origin_{0.0}, direction_{0.0};  // along these axes
    Vec3 shear_{0.0};
};

inline std::optional<Hit> ShearedRay::hit(const Vec3& a,
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

}  // namespace earshot::geometry
