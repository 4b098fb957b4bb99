// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
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

/// A line prepared for many boxes. Errs to the large side: each box is padded by 2^-45 of the
/// coordinates involved, 256 units in the last place, which is far more than the distances here and
/// the triangle tests below can be off (where Ize 2013 widens the distances instead). Passages are
/// monotone: of a box inside another the passage lies inside the other's, in floating point.
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

/// A ray prepared for many boxes and triangles: the one place where a ray's hits are decided.
///
/// Triangles by the watertight test of Woop, Benthin and Wald 2013, in double precision: vertices
/// are moved and sheared so that the ray runs along an axis, and three edge functions decide. Each
/// depends on its two vertices only and changes sign exactly when they are swapped, and zero counts
/// as inside, so no ray slips between triangles that share an edge. Both sides of a triangle are
/// hit; a triangle seen edge-on is not (its neighbours are).
///
/// hit() also demands that the line passes the triangle's own box and moves t into that passage,
/// before it asks whether t lies in [0, most]. So a search may leave out every box that is not
/// passed, or passed later than a hit already found, and the answer is the same to the last bit
/// with any hierarchy.
class PreparedRay {
public:
    /// `reach`: the largest absolute coordinate of any box or vertex the ray will be tested
    /// against, metres.
    PreparedRay(const Ray& ray, double reach) noexcept;

    /// False: the ray hits nothing, because a component of origin or direction is not finite, the
    /// direction's largest component is not within 2^-500 ... 2^500, or t_max is negative or not a
    /// number.
    bool is_valid() const noexcept { return t_max_ >= 0.0; }
    double t_max() const noexcept { return t_max_; }

    /// The part of a box that the ray passes between t = 0 and t = most.
    Passage passage(const Aabb& box, double most) const noexcept {
        return slabs_.passage(box, most);
    }

    /// The ray's hit of a triangle at `most` at the farthest. Hit::triangle is left 0.
    std::optional<Hit> hit(const Vec3& a, const Vec3& b, const Vec3& c, double most) const noexcept;

private:
    Slabs slabs_;
    double t_max_ = -1.0;
    std::size_t axis_x_ = 0, axis_y_ = 1, axis_z_ = 2;
    Vec3 origin_{0.0};  // along these axes
    Vec3 shear_{0.0};
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
