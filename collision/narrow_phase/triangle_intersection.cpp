// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/triangle_intersection.h"

#include "earshot/geometry/overlap.h"
#include "earshot/geometry/predicates.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::collision {

using geometry::determinant2d;
using geometry::determinant3d;
using geometry::orient2d;
using geometry::orient3d;
using geometry::Segment;
using geometry::TriangleRegion;
using geometry::Vec3;

namespace {

int sign(double value) noexcept {
    return (value > 0.0 ? 1 : 0) - (value < 0.0 ? 1 : 0);
}

Vec3 absolute(const Vec3& v) noexcept {
    return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

using Sides = std::array<int, 3>;

/// On which side of a triangle's plane three points lie, with the signs of orient3d(). Exact.
Sides sides_of(const Corners& plane, const Corners& points) noexcept {
    // The determinant of orient3d() expanded around the triangle's first corner, so that the three
    // share their minors: the same roundings, hence its error bound.
    constexpr double kBound = (7.0 + 56.0 * 0x1p-53) * 0x1p-53;
    const Vec3 u = plane[1] - plane[0];
    const Vec3 v = plane[2] - plane[0];
    const Vec3 forth(u.y * v.z, u.z * v.x, u.x * v.y);
    const Vec3 back(u.z * v.y, u.x * v.z, u.y * v.x);
    const Vec3 normal = forth - back;
    const Vec3 permanent = absolute(forth) + absolute(back);
    Sides sides{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 w = points[i] - plane[0];
        const double height = glm::dot(normal, w);
        const bool is_certain = std::abs(height) > kBound * glm::dot(permanent, absolute(w));
        sides[i] = is_certain ? -sign(height) : orient3d(plane[0], plane[1], plane[2], points[i]);
    }
    return sides;
}

bool is_one_sided(const Sides& sides) noexcept {
    return sides[0] != 0 && sides[0] == sides[1] && sides[0] == sides[2];
}

bool has_zero(const Sides& sides) noexcept {
    return sides[0] * sides[1] * sides[2] == 0;
}

/// Two triangles each of which has corners strictly on both sides of the other's plane, brought
/// into the canonical order in which their cuts with the line of both planes can be compared
/// (Guigue and Devillers 2003, section 3): corner 0 of each is alone on its side, the upper one, of
/// the other's plane. Along the line a's cut then runs from edge 0-2 to edge 0-1, and b's from 0-1
/// to 0-2.
struct Crossing {
    Corners a, b;

    Crossing(Corners one, Sides one_sides, Corners other, Sides other_sides) noexcept
        : a(one), b(other) {
        const bool one_is_above = put_lone_corner_first(a, one_sides);
        const bool other_is_above = put_lone_corner_first(b, other_sides);
        // Turning a triangle round turns its plane over.
        if (!one_is_above) {
            std::swap(b[1], b[2]);
        }
        if (!other_is_above) {
            std::swap(a[1], a[2]);
        }
    }

    /// Whether b's edge 0-j cuts the line no later than a's edge 0-i.
    bool b_is_first(std::size_t i, std::size_t j) const noexcept {
        return orient3d(a[0], a[i], b[0], b[j]) >= 0;
    }
    bool intersect() const noexcept {
        return b_is_first(1, 1) && orient3d(a[0], a[2], b[0], b[2]) <= 0;
    }

private:
    /// Returns whether that corner lies above the other's plane.
    static bool put_lone_corner_first(Corners& corners, const Sides& sides) noexcept {
        const std::size_t lone = sides[0] == sides[1] ? 2 : sides[0] == sides[2] ? 1 : 0;
        std::rotate(corners.begin(), corners.begin() + static_cast<int>(lone), corners.end());
        return sides[lone] < 0;
    }
};

/// Where a segment with ends on both sides of a plane, at determinants `start` and `end`, cuts it.
Vec3 cut(const Vec3& from, const Vec3& to, double start, double end) noexcept {
    return from + start / (start - end) * (to - from);
}

Vec3 cut(const Vec3& from, const Vec3& to, const Corners& plane) noexcept {
    return cut(from,
               to,
               determinant3d(plane[0], plane[1], plane[2], from),
               determinant3d(plane[0], plane[1], plane[2], to));
}

/// Whether two triangles have the same corners in any order.
bool are_same(const Corners& one, const Corners& other) noexcept {
    return std::is_permutation(one.begin(), one.end(), other.begin());
}

bool is_before(const Vec3& a, const Vec3& b) noexcept {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

Segment in_order(const Vec3& a, const Vec3& b) noexcept {
    return is_before(b, a) ? Segment{b, a} : Segment{a, b};
}

Segment cut_of(const Crossing& crossing) noexcept {
    const Corners& a = crossing.a;
    const Corners& b = crossing.b;
    const Vec3 first = crossing.b_is_first(2, 1) ? cut(a[0], a[2], b) : cut(b[0], b[1], a);
    const Vec3 last = crossing.b_is_first(1, 2) ? cut(b[0], b[2], a) : cut(a[0], a[1], b);
    return in_order(first, last);
}

/// Points of the intersection of two triangles, among them all corners of the polygon, segment or
/// point that it is.
class IntersectionPoints {
public:
    void add_all_of(const Corners& one, const Corners& other) noexcept {
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& from = one[i];
            const Vec3& to = one[(i + 1) % 3];
            if (TriangleRegion(from, from, from).touches(other[0], other[1], other[2])) {
                add(from);
            }
            if (TriangleRegion(from, to, to).touches(other[0], other[1], other[2])) {
                add_crossing(from, to, other);
            }
        }
    }

    void add_corners_of(const Corners& triangle) noexcept {
        for (const Vec3& corner : triangle) {
            add(corner);
        }
    }

    Segment farthest_pair() const noexcept {
        Segment best{points_[0], points_[0]};
        double longest = 0.0;
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                const Vec3 between = points_[i] - points_[k];
                const double length = glm::dot(between, between);
                if (length > longest) {
                    longest = length;
                    best = in_order(points_[i], points_[k]);
                }
            }
        }
        return best;
    }

private:
    void add(const Vec3& point) noexcept { points_[count_++] = point; }

    /// The point where a segment that touches the triangle passes through it or, if coplanar,
    /// through its edges. Corners are added elsewhere.
    void add_crossing(const Vec3& from, const Vec3& to, const Corners& t) noexcept {
        const int start = orient3d(t[0], t[1], t[2], from);
        const int end = orient3d(t[0], t[1], t[2], to);
        if (start * end < 0) {
            add(cut(from, to, t));
        }
        if (start != 0 || end != 0) {
            return;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& left = t[i];
            const Vec3& right = t[(i + 1) % 3];
            if (TriangleRegion(from, to, to).touches(left, right, right)) {
                add_crossing_in_plane(from, to, left, right);
            }
        }
    }

    void add_crossing_in_plane(const Vec3& from,
                               const Vec3& to,
                               const Vec3& left,
                               const Vec3& right) noexcept {
        for (int axis = 0; axis < 3; ++axis) {
            const auto flat = [&](const Vec3& p) {
                return glm::dvec2(p[(axis + 1) % 3], p[(axis + 2) % 3]);
            };
            const auto side = [&](const Vec3& p) {
                return orient2d(flat(left), flat(right), flat(p));
            };
            if (side(from) * side(to) < 0) {
                add(cut(from,
                        to,
                        determinant2d(flat(left), flat(right), flat(from)),
                        determinant2d(flat(left), flat(right), flat(to))));
                return;
            }
        }
    }

    // Per edge of the six: its beginning, and a crossing with each of three others.
    std::array<Vec3, 24> points_{};
    std::size_t count_ = 0;
};

}  // namespace

bool intersect(const Corners& one, const Corners& other) noexcept {
    const Sides one_sides = sides_of(other, one);
    if (is_one_sided(one_sides)) {
        return false;
    }
    const Sides other_sides = sides_of(one, other);
    if (is_one_sided(other_sides)) {
        return false;
    }
    if (has_zero(one_sides) || has_zero(other_sides)) {
        return TriangleRegion(one[0], one[1], one[2]).touches(other[0], other[1], other[2]);
    }
    return Crossing(one, one_sides, other, other_sides).intersect();
}

std::optional<Segment> intersection(const Corners& one, const Corners& other) noexcept {
    const Sides one_sides = sides_of(other, one);
    const Sides other_sides = sides_of(one, other);
    if (is_one_sided(one_sides) || is_one_sided(other_sides)) {
        return std::nullopt;
    }
    if (!has_zero(one_sides) && !has_zero(other_sides)) {
        const Crossing crossing(one, one_sides, other, other_sides);
        return crossing.intersect() ? std::optional(cut_of(crossing)) : std::nullopt;
    }
    IntersectionPoints points;
    if (are_same(one, other)) {
        // As below, where the crossings of equal edges are their ends.
        points.add_corners_of(one);
        return points.farthest_pair();
    }
    if (!TriangleRegion(one[0], one[1], one[2]).touches(other[0], other[1], other[2])) {
        return std::nullopt;
    }
    points.add_all_of(one, other);
    points.add_all_of(other, one);
    return points.farthest_pair();
}

}  // namespace earshot::collision
