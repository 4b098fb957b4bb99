// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/sheared_ray.h"
#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

namespace earshot::geometry {

/// The slab test of a line against boxes (Kay and Kajiya 1986), prepared for many of them. Errs to
/// the large side: each box is padded by 2^-38 of the coordinates involved (a hundredth of a
/// nanometre at 40 m), which is far more than the distances here and the triangle tests below can
/// be off (where Ize 2013 widens the distances instead). Intervals are monotone: that of a box
/// inside another lies inside the other's, in floating point.
class SlabTest {
public:
    /// `max_abs_coordinate`: the largest absolute coordinate of any box that will be tested,
    /// metres. Precondition: finite.
    SlabTest(const Vec3& origin, const Vec3& direction, double max_abs_coordinate) noexcept;

    /// Where the line is inside the box, within 0 <= t <= t_max, in multiples of its direction.
    Interval interval(const Aabb& box, double t_max) const noexcept {
        return clip(box, {0.0, t_max});
    }

    /// The same of the whole line.
    Interval interval(const Aabb& box) const noexcept {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return clip(box, {-kInfinity, kInfinity});
    }

private:
    Interval clip(const Aabb& box, Interval t) const noexcept {
        for (std::size_t k = 0; k < 3; ++k) {
            const float first = is_forward_[k] ? box.lower[k] : box.upper[k];
            const float last = is_forward_[k] ? box.upper[k] : box.lower[k];
            const double enter = (static_cast<double>(first) - before_[k]) * inverse_[k];
            const double leave = (static_cast<double>(last) - after_[k]) * inverse_[k];
            t.min = enter > t.min ? enter : t.min;
            t.max = leave < t.max ? leave : t.max;
        }
        return t;
    }

    std::array<bool, 3> is_forward_{};
    std::array<double, 3> before_{}, after_{};  // origin, moved by the padding
    std::array<double, 3> inverse_{};           // of the direction
};

/// A ray prepared for many boxes and triangles.
class PreparedRay {
public:
    /// `max_abs_coordinate`: the largest absolute coordinate of any box or vertex the ray will be
    /// tested against, metres.
    PreparedRay(const Ray& ray, double max_abs_coordinate) noexcept
        : slab_test_(ray.origin, ray.direction, max_abs_coordinate),
          sheared_(ray),
          max_abs_coordinate_(max_abs_coordinate) {}

    /// See ShearedRay.
    bool is_valid() const noexcept { return sheared_.is_valid(); }
    double t_max() const noexcept { return sheared_.t_max(); }

    /// See SlabTest.
    Interval box_interval(const Aabb& box, double t_max) const noexcept {
        return slab_test_.interval(box, t_max);
    }

    /// See ShearedRay.
    std::optional<Hit> hit(const Vec3& a,
                           const Vec3& b,
                           const Vec3& c,
                           double t_max) const noexcept {
        return sheared_.hit(a, b, c, t_max, max_abs_coordinate_);
    }

private:
    SlabTest slab_test_;
    ShearedRay sheared_;
    double max_abs_coordinate_;
};

/// The outward-rounded box of a triangle.
Aabb triangle_box(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Whether the closed segment and the closed triangle share a point: decided exactly, coplanar
/// cases included. A triangle without area touches nothing. Precondition: finite.
bool touches(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// The parameter (0 at `from`, 1 at `to`) where the closed segment first touches the closed
/// triangle, within 2^-37 however flat the angle; empty if touches() is false. Same precondition.
std::optional<double> first_touch(const Segment& segment,
                                  const Vec3& a,
                                  const Vec3& b,
                                  const Vec3& c) noexcept;

}  // namespace earshot::geometry
