// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

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
    explicit ShearedRay(const Ray& ray) noexcept;

    /// Whether a ray may hit anything; `size` is the largest component of its direction. Inline for
    /// kernels: without products there is nothing to contract.
    static bool takes(const Ray& ray, double size) noexcept {
        const Vec3& d = ray.direction;
        const double sum = (ray.origin.x + ray.origin.y + ray.origin.z) + (d.x + d.y + d.z);
        // A sum is finite only if its terms are; it overflows only where no scene is.
        return sum - sum == 0.0 && size >= kMinDirection && size <= kMaxDirection &&
               ray.t_max >= 0.0;
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
    static constexpr double kMinDirection = 0x1p-500;
    static constexpr double kMaxDirection = 0x1p500;

    Vec3 along(const Vec3& v) const noexcept;
    std::optional<double> move_into_own_box(double t,
                                            const Vec3& a,
                                            const Vec3& b,
                                            const Vec3& c,
                                            double max_abs_coordinate) const noexcept;

    double t_max_ = -1.0;
    RayAxes axes_{};
    Vec3 origin_{0.0}, direction_{0.0};  // along the axes
    Vec3 shear_{0.0};
};

}  // namespace earshot::geometry
