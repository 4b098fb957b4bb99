// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"
#include "earshot/geometry/vector.h"

#include <cstddef>
#include <limits>
#include <optional>

namespace earshot::geometry {

/// The point of a mesh closest to another point.
struct ClosestPoint {
    TriangleId triangle = 0;
    double distance = 0.0;  ///< metres, within 2^-46 of distance and triangle's size together
    Vec3 point{0.0};        ///< on the triangle, metres
    /// Of the triangle's vertices; their sum is 1 but for rounding. On an edge the opposite vertex
    /// weighs exactly 0, at a vertex both others do.
    Vec3 weights{1.0, 0.0, 0.0};

    friend bool operator==(const ClosestPoint&, const ClosestPoint&) = default;
};

/// A point prepared for many boxes and triangles: the one place where distances are decided.
///
/// squared_distance() is monotone in floating point: of a box inside another it is no smaller than
/// the other's, because every step (a difference with a fixed number, a maximum, a square, a sum)
/// is. A triangle is by definition no nearer than the box of its corners. So a search may leave out
/// every box that is farther than a triangle already found, and the answer is the same to the last
/// bit with any hierarchy.
class PreparedPoint {
public:
    explicit PreparedPoint(const Vec3& point) noexcept : point_(point) {}

    /// False: nothing is near it, because a coordinate is not finite.
    bool is_valid() const noexcept { return is_finite(point_); }

    /// Of the box, within 2^-51 relatively; infinite for the empty box.
    double squared_distance(const Aabb& box) const noexcept {
        double squared = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            squared += squared_gap(
                static_cast<double>(box.lower[k]), static_cast<double>(box.upper[k]), axis);
        }
        return squared;
    }

    /// The squared distance beyond which no box holds a triangle at `max_distance` metres or
    /// nearer. Infinite numbers are their own bounds; NaN becomes NaN, which lets nothing pass.
    static double squared_bound(double max_distance) noexcept {
        // The factor is far above what kShrink and the root take away; the summand, far below any
        // distance squared, keeps the product from underflowing.
        constexpr double kGrow = 1.0 + 0x1p-40;
        return max_distance < 0.0 ? -1.0 : max_distance * max_distance * kGrow + 0x1p-1000;
    }

    /// The triangle's closest point if it is at `max_distance` metres at the farthest.
    /// ClosestPoint::triangle is left 0. Triangles without area are segments or points. Of an edge
    /// that two triangles share both report the same point, whatever their order of vertices.
    std::optional<ClosestPoint> closest_point(const Vec3& a,
                                              const Vec3& b,
                                              const Vec3& c,
                                              double max_distance) const noexcept;

private:
    // Keeps the box of a triangle's corners from moving a distance that is as precise.
    static constexpr double kShrink = 1.0 - 0x1p-48;

    double squared_gap(double lower, double upper, int axis) const noexcept {
        const double below = lower - point_[axis];
        const double above = point_[axis] - upper;
        const double outside = below > above ? below : above;
        const double gap = outside > 0.0 ? outside : 0.0;
        return gap * gap;
    }

    Vec3 point_;
};

}  // namespace earshot::geometry
