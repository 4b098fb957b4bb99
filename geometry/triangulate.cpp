// SPDX-License-Identifier: MIT
#include "earshot/geometry/triangulate.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/internal/projection.h"
#include "earshot/geometry/predicates.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

namespace earshot::geometry {
namespace {

using Points = std::span<const glm::dvec2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double squared_distance(const glm::dvec2& a, const glm::dvec2& b) noexcept {
    const glm::dvec2 along = b - a;
    return along.x * along.x + along.y * along.y;
}

/// Whether `p`, which is collinear with a and b, lies strictly between them.
bool strictly_between(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) noexcept {
    return p != a && p != b && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
           std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

/// Whether two segments have a point in common other than shared ends.
bool intersect(const glm::dvec2& a,
               const glm::dvec2& b,
               const glm::dvec2& c,
               const glm::dvec2& d) noexcept {
    const int abc = orient2d(a, b, c);
    const int abd = orient2d(a, b, d);
    const int cda = orient2d(c, d, a);
    const int cdb = orient2d(c, d, b);
    if (abc * abd < 0 && cda * cdb < 0) {
        return true;
    }
    return (abc == 0 && strictly_between(a, b, c)) || (abd == 0 && strictly_between(a, b, d)) ||
           (cda == 0 && strictly_between(c, d, a)) || (cdb == 0 && strictly_between(c, d, b));
}

bool intersects_any(Points points,
                    const glm::dvec2& a,
                    const glm::dvec2& b,
                    const std::vector<IndexLoop>& loops) noexcept {
    for (const IndexLoop& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            if (intersect(a, b, points[loop[i]], points[loop[(i + 1) % loop.size()]])) {
                return true;
            }
        }
    }
    return false;
}

/// Joins the last loop, a hole, to the outline by the shortest bridge that crosses nothing: the
/// outline runs over the bridge, around the hole and back.
void bridge_last_hole(Points points, std::vector<IndexLoop>& loops) {
    const IndexLoop hole = loops.back();
    IndexLoop& outline = loops.front();
    std::size_t from = 0;
    std::size_t to = 0;
    double shortest = kInfinity;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        for (std::size_t j = 0; j < hole.size(); ++j) {
            const glm::dvec2& start = points[outline[i]];
            const glm::dvec2& end = points[hole[j]];
            const double length = squared_distance(start, end);
            if (length < shortest && !intersects_any(points, start, end, loops)) {
                shortest = length;
                from = i;
                to = j;
            }
        }
    }
    EARSHOT_ASSERT(shortest != kInfinity);
    IndexLoop detour;
    for (std::size_t j = 0; j <= hole.size(); ++j) {
        detour.push_back(hole[(to + j) % hole.size()]);
    }
    detour.push_back(outline[from]);
    outline.insert(
        outline.begin() + static_cast<std::ptrdiff_t>(from) + 1, detour.begin(), detour.end());
    loops.pop_back();
}

/// Makes one loop of an outline and its holes. The holes farthest to the left are joined first, so
/// that a bridge to one on their right may start at them.
IndexLoop joined(Points points, std::vector<IndexLoop> loops) {
    const auto leftmost = [&](const IndexLoop& loop) {
        double x = kInfinity;
        for (const std::size_t corner : loop) {
            x = std::min(x, points[corner].x);
        }
        return x;
    };
    std::stable_sort(loops.begin() + 1, loops.end(), [&](const IndexLoop& a, const IndexLoop& b) {
        return leftmost(a) > leftmost(b);
    });
    while (loops.size() > 1) {
        bridge_last_hole(points, loops);
    }
    return std::move(loops.front());
}

/// A polygon from which ears are cut off. For each corner it knows another that keeps it from being
/// an ear: until that one is cut off or a neighbour changes, the corner need not be tested again,
/// and those tested before it do not hinder. So all tests take O(n^2).
class EarClipper {
public:
    EarClipper(Points points, const IndexLoop& loop) : points_(points) {
        for (const std::size_t point : loop) {
            loop_.push_back(corners_.size());
            corners_.push_back({.point = point});
        }
    }

    std::size_t corner_count() const noexcept { return loop_.size(); }

    std::array<std::size_t, 3> cut(EarOrder order) {
        const std::size_t i =
            order == EarOrder::successive ? successive_ear() : ear_of_shortest_diagonal();
        Corner& before = corners_[before_of(i)];
        Corner& ear = corners_[loop_[i]];
        Corner& after = corners_[after_of(i)];
        ear.is_cut = true;
        before.tested = after.tested = 0;
        loop_.erase(loop_.begin() + static_cast<std::ptrdiff_t>(i));
        next_ = i;
        return {before.point, ear.point, after.point};
    }

private:
    struct Corner {
        std::size_t point = 0;
        bool is_cut = false;
        std::size_t tested = 0;  // the corners before this number do not keep it from being an ear
    };

    std::size_t before_of(std::size_t i) const {
        return loop_[(i + loop_.size() - 1) % loop_.size()];
    }
    std::size_t after_of(std::size_t i) const { return loop_[(i + 1) % loop_.size()]; }
    const glm::dvec2& point_of(std::size_t corner) const { return points_[corners_[corner].point]; }

    std::size_t successive_ear() {
        std::size_t i = next_ % loop_.size();
        for (std::size_t tried = 0; tried < loop_.size() && !is_ear(i); ++tried) {
            i = (i + 1) % loop_.size();
        }
        return i;
    }

    std::size_t ear_of_shortest_diagonal() {
        if (loop_.size() == 3) {
            return 1;  // what is left, from its first corner on
        }
        std::size_t best = next_ % loop_.size();
        double shortest = kInfinity;
        for (std::size_t i = 0; i < loop_.size(); ++i) {
            const double diagonal = squared_distance(point_of(before_of(i)), point_of(after_of(i)));
            if (diagonal < shortest && is_ear(i)) {
                shortest = diagonal;
                best = i;
            }
        }
        return best;
    }

    /// The corner is convex and no other corner lies in its triangle or on it. Corners that
    /// coincide with the triangle's (the two sides of a bridge) do not hinder.
    bool is_ear(std::size_t i) {
        const glm::dvec2& a = point_of(before_of(i));
        const glm::dvec2& b = point_of(loop_[i]);
        const glm::dvec2& c = point_of(after_of(i));
        if (orient2d(a, b, c) <= 0) {
            return false;
        }
        const auto hinders = [&](const Corner& corner) {
            const glm::dvec2& p = points_[corner.point];
            return !corner.is_cut && p != a && p != b && p != c && orient2d(a, b, p) >= 0 &&
                   orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0;
        };
        std::size_t& tested = corners_[loop_[i]].tested;
        while (tested < corners_.size() && !hinders(corners_[tested])) {
            ++tested;
        }
        return tested == corners_.size();
    }

    Points points_;
    std::vector<Corner> corners_;    // all of them, cut off or not
    std::vector<std::size_t> loop_;  // those that are left, in order
    std::size_t next_ = 1;           // where the search for a successive ear begins
};

/// The area vector of a closed polygon, planar or not, relative to its first corner (Sutherland,
/// Sproull, Schumacker 1974, after Newell).
Vec3 area_vector(std::span<const Vec3> positions, std::span<const VertexId> polygon) {
    const Vec3 origin = positions[polygon[0]];
    Vec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        sum += glm::cross(positions[polygon[i]] - origin, positions[polygon[i + 1]] - origin);
    }
    return sum;
}

/// The polygon projected along the axis closest to its area vector, counter-clockwise.
std::vector<glm::dvec2> projected(std::span<const Vec3> positions,
                                  std::span<const VertexId> polygon) {
    const Vec3 area = area_vector(positions, polygon);
    const Vec3 size = glm::abs(area);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : 1;
    axis = size.z > size.x && size.z > size.y ? 2 : axis;
    std::vector<glm::dvec2> points;
    points.reserve(polygon.size());
    for (const VertexId vertex : polygon) {
        const glm::dvec2 point = project_along(positions[vertex], axis);
        points.push_back(area[axis] < 0.0 ? glm::dvec2(point.y, point.x) : point);
    }
    return points;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> triangulate(std::span<const glm::dvec2> points,
                                                    std::vector<IndexLoop> loops,
                                                    EarOrder order) {
    EARSHOT_ASSERT(!loops.empty());
    EarClipper clipper(points, joined(points, std::move(loops)));
    std::vector<std::array<std::size_t, 3>> triangles;
    while (clipper.corner_count() >= 3) {
        triangles.push_back(clipper.cut(order));
    }
    return triangles;
}

std::vector<Triangle> triangulate(std::span<const Vec3> positions,
                                  std::span<const VertexId> polygon) {
    if (polygon.size() < 3) {
        return {};
    }
    if (polygon.size() == 3) {
        return {{polygon[0], polygon[1], polygon[2]}};
    }
    IndexLoop outline(polygon.size());
    std::iota(outline.begin(), outline.end(), std::size_t{0});
    const std::vector<glm::dvec2> points = projected(positions, polygon);
    std::vector<Triangle> triangles;
    for (const auto& [a, b, c] : triangulate(points, {std::move(outline)}, EarOrder::successive)) {
        triangles.push_back({polygon[a], polygon[b], polygon[c]});
    }
    return triangles;
}

}  // namespace earshot::geometry
