// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/sheared_ray.h"
#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

namespace earshot::geometry {

/// The part of a line inside a box, in multiples of its direction. Missed if near > far.
struct Passage {
    double near = 0.0;
    double far = 0.0;

    bool is_empty() const noexcept { return near > far; }
};

/// A line prepared for many boxes. Errs to the large side: each box is padded by 2^-38 of the
/// coordinates involved (a hundredth of a nanometre at 40 m), which is far more than the distances
/// here and the triangle tests below can be off (where Ize 2013 widens the distances instead).
/// Passages are monotone: of a box inside another the passage lies inside the other's, in floating
/// point.
class Slabs {
public:
    /// `reach`: the largest absolute coordinate of any box that will be tested, metres.
    /// Precondition: finite.
    Slabs(const Vec3& origin, const Vec3& direction, double reach) noexcept;

    /// The passage of the part of the line between t = 0 and t = most.
    Passage passage(const Aabb& box, double most) const noexcept { return cut(box, {0.0, most}); }

    /// The passage of the whole line.
    Passage passage(const Aabb& box) const noexcept {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return cut(box, {-kInfinity, kInfinity});
    }

private:
    Passage cut(const Aabb& box, Passage part) const noexcept {
        for (std::size_t k = 0; k < 3; ++k) {
            const float first = is_forward_[k] ? box.lower[k] : box.upper[k];
            const float last = is_forward_[k] ? box.upper[k] : box.lower[k];
            const double enter = (static_cast<double>(first) - before_[k]) * inverse_[k];
            const double leave = (static_cast<double>(last) - after_[k]) * inverse_[k];
            part.near = enter > part.near ? enter : part.near;
            part.far = leave < part.far ? leave : part.far;
        }
        return part;
    }

    std::array<bool, 3> is_forward_{};
    std::array<double, 3> before_{}, after_{};  // origin, moved by the padding
    std::array<double, 3> inverse_{};           // of the direction
};

/// A ray prepared for many boxes and triangles.
class PreparedRay {
public:
    /// `reach`: the largest absolute coordinate of any box or vertex the ray will be tested
    /// against, metres.
    PreparedRay(const Ray& ray, double reach) noexcept
        : slabs_(ray.origin, ray.direction, reach), sheared_(ray), reach_(reach) {}

    /// See ShearedRay.
    bool is_valid() const noexcept { return sheared_.is_valid(); }
    double t_max() const noexcept { return sheared_.t_max(); }

    /// The part of a box that the ray passes between t = 0 and t = most.
    Passage passage(const Aabb& box, double most) const noexcept {
        return slabs_.passage(box, most);
    }

    /// See ShearedRay.
    std::optional<Hit> hit(const Vec3& a,
                           const Vec3& b,
                           const Vec3& c,
                           double most) const noexcept {
        return sheared_.hit(a, b, c, most, reach_);
    }

private:
    Slabs slabs_;
    ShearedRay sheared_;
    double reach_;
};

/// The outward-rounded box of a triangle.
Aabb triangle_box(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Whether the closed segment and the closed triangle share a point: decided exactly, coplanar
/// cases included. Precondition: finite, and the triangle has an area.
bool touches(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// The parameter (0 at `from`, 1 at `to`) where the closed segment first touches the closed
/// triangle, within 2^-37 however flat the angle; empty if touches() is false. Same precondition.
std::optional<double> first_touch(const Segment& segment,
                                  const Vec3& a,
                                  const Vec3& b,
                                  const Vec3& c) noexcept;

}  // namespace earshot::geometry
