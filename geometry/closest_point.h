// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

#include <cmath>
#include <limits>
#include <optional>

namespace earshot::geometry {

/// The point of a mesh nearest to another point.
struct NearPoint {
    TriangleId triangle = 0;
    double distance = 0.0;  ///< metres, within 2^-46 of distance and triangle's size together
    Vec3 point{0.0};        ///< on the triangle, metres
    /// Of the triangle's vertices; their sum is 1 but for rounding. On an edge the opposite vertex
    /// weighs exactly 0, at a vertex both others do.
    Vec3 weights{1.0, 0.0, 0.0};

    friend bool operator==(const NearPoint&, const NearPoint&) = default;
};

/// A point prepared for many boxes and triangles: the one place where distances are decided.
///
/// distance(box) is monotone in floating point: of a box inside another it is no smaller than the
/// other's, because every step (a difference with a fixed number, a maximum, a square, a sum, a
/// root) is. A triangle is by definition no nearer than its own outward-rounded box. So a search
/// may leave out every box that is farther than a triangle already found, and the answer is the
/// same to the last bit with any hierarchy.
class PreparedPoint {
public:
    explicit PreparedPoint(const Vec3& point) noexcept : point_(point) {}

    /// False: nothing is near it, because a coordinate is not finite.
    bool is_valid() const noexcept {
        return std::isfinite(point_.x) && std::isfinite(point_.y) && std::isfinite(point_.z);
    }

    /// A lower bound of the distance to anything in the box, metres; infinite for the empty box.
    double distance(const Aabb& box) const noexcept {
        // Within 2^-51 of the true distance, relatively: one rounding per difference, square and
        // sum. Shrinking by more keeps a box from moving a triangle whose distance is as precise.
        constexpr double kShrink = 1.0 - 0x1p-48;
        double squared = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            const double below = static_cast<double>(box.lower[k]) - point_[axis];
            const double above = point_[axis] - static_cast<double>(box.upper[k]);
            const double gap = below > above ? below : above;
            squared += gap > 0.0 ? gap * gap : 0.0;
        }
        return kShrink * std::sqrt(squared);
    }

    /// The triangle's nearest point if it is at `most` metres at the farthest. NearPoint::triangle
    /// is left 0. Triangles without area are segments or points. Of an edge that two triangles
    /// share both report the same point, whatever their order of vertices.
    std::optional<NearPoint> nearest(const Vec3& a,
                                     const Vec3& b,
                                     const Vec3& c,
                                     double most) const noexcept;

private:
    Vec3 point_;
};

}  // namespace earshot::geometry
