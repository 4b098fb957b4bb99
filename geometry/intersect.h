// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

#include <array>
#include <optional>

namespace earshot::geometry {

/// Where a line passes a box, in multiples of its direction.
struct Passage {
    double near = 0.0;
    double far = 0.0;
};

/// The part t >= 0 of a line, prepared for many boxes. Errs to the large side: each box is padded
/// by 2^-45 of the coordinates involved (256 units in the last place, far more than the triangle
/// tests below can be off) and each distance by a few units of its own (Ize 2013). passage() is
/// monotone: of a box inside another the passage lies inside the other's, in floating point.
class Slabs {
public:
    /// `reach`: the largest absolute coordinate of any box that will be tested, metres. Components
    /// of the direction too small to have a finite inverse count as 0. Precondition: finite.
    Slabs(const Vec3& origin, const Vec3& direction, double reach) noexcept;

    /// Empty if the line does not pass the box between t = 0 and t = most.
    std::optional<Passage> passage(const Aabb& box, double most) const noexcept {
        double near = 0.0;
        double far = most;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            const double lower = static_cast<double>(box.lower[k]) - pad_ - origin_[axis];
            const double upper = static_cast<double>(box.upper[k]) + pad_ - origin_[axis];
            if (is_flat_[k]) {
                if (lower > 0.0 || upper < 0.0) {
                    return std::nullopt;
                }
                continue;
            }
            const bool forward = inverse_[axis] > 0.0;
            const double enter = (forward ? lower : upper) * inverse_[axis] * kBefore;
            const double leave = (forward ? upper : lower) * inverse_[axis] * kAfter;
            near = enter > near ? enter : near;
            far = leave < far ? leave : far;
        }
        if (near > far) {
            return std::nullopt;
        }
        return Passage{near, far};
    }

private:
    // Three roundings of 2^-53 each, and some.
    static constexpr double kBefore = 1.0 - 0x1p-50;
    static constexpr double kAfter = 1.0 + 0x1p-50;

    Vec3 origin_;
    Vec3 inverse_{0.0};  // of the direction
    std::array<bool, 3> is_flat_{};
    double pad_ = 0.0;
};

/// A ray prepared for many boxes and triangles: the one place where a ray's hits are decided.
///
/// Triangles by the watertight test of Woop, Benthin and Wald 2013, in double precision: vertices
/// are moved and sheared so that the ray runs along an axis, and three edge functions decide. Each
/// depends on its two vertices only and changes sign exactly when they are swapped, and zero counts
/// as inside, so no ray slips between triangles that share an edge. Both sides of a triangle are
/// hit; a triangle seen edge-on is not (its neighbours are).
///
/// hit() also demands that the ray passes the triangle's own box and moves t into that passage. So
/// a search may leave out every box that is not passed, or passed later than a hit already found,
/// and the answer is the same to the last bit with any hierarchy.
class PreparedRay {
public:
    /// `reach`: the largest absolute coordinate of any box or vertex the ray will be tested
    /// against, metres.
    PreparedRay(const Ray& ray, double reach) noexcept;

    /// False: the ray hits nothing, because a component of origin or direction is not finite, the
    /// direction is zero, or t_max is negative or not a number.
    bool is_valid() const noexcept { return t_max_ >= 0.0; }
    double t_max() const noexcept { return t_max_; }

    std::optional<Passage> passage(const Aabb& box, double most) const noexcept {
        return slabs_.passage(box, most);
    }

    /// The ray's hit of a triangle at `most` at the farthest. Hit::triangle is left 0.
    std::optional<Hit> hit(const Vec3& a, const Vec3& b, const Vec3& c, double most) const noexcept;

private:
    Slabs slabs_;
    Vec3 origin_;
    double t_max_ = -1.0;
    int axis_x_ = 0, axis_y_ = 1, axis_z_ = 2;
    Vec3 shear_{0.0};
};

/// The outward-rounded box of a triangle.
Aabb triangle_box(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Whether the closed segment and the closed triangle share a point: decided exactly, coplanar
/// cases included. Precondition: finite, and the triangle has an area.
bool touches(const Segment& segment, const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// The parameter (0 at `from`, 1 at `to`) where the closed segment first touches the closed
/// triangle, rounded; empty if touches() is false. Same precondition.
std::optional<double> first_touch(const Segment& segment,
                                  const Vec3& a,
                                  const Vec3& b,
                                  const Vec3& c) noexcept;

}  // namespace earshot::geometry
