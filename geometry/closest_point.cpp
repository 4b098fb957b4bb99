// SPDX-License-Identifier: MIT
#include "earshot/geometry/closest_point.h"

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace earshot::geometry {
namespace {

/// A point of the triangle, and its offset from the query point.
struct Candidate {
    Vec3 offset{0.0};
    Vec3 weights{0.0};
};

/// Where between two points (0 ... 1) the origin is nearest; they are given relative to it.
double closest_fraction(const Vec3& from, const Vec3& along) noexcept {
    const double length_squared = glm::dot(along, along);
    if (!(length_squared > 0.0)) {
        return 0.0;
    }
    return std::clamp(-glm::dot(from, along) / length_squared, 0.0, 1.0);
}

/// The edge from corner i to the next.
Candidate on_edge(const Corners& corners, const Vec3& query, int i) noexcept {
    int from = i;
    int to = (i + 1) % 3;
    const auto corner = [&](int k) -> const Vec3& { return corners[static_cast<std::size_t>(k)]; };
    if (lexicographic_less(corner(to), corner(from))) {
        std::swap(from, to);
    }
    const Vec3 start = corner(from) - query;
    const Vec3 along = corner(to) - corner(from);
    const double fraction = closest_fraction(start, along);
    Candidate found;
    found.offset = fraction == 1.0 ? corner(to) - query : start + fraction * along;
    found.weights[from] = 1.0 - fraction;
    found.weights[to] = fraction;
    return found;
}

double size_of(const Vec3& v) noexcept {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

/// Where the foot of the perpendicular lies: weights of the corners, each times the square of the
/// normal's length.
struct Foot {
    Vec3 start{0.0}, ab{0.0}, ac{0.0};  // from the point to the first corner, and on to the others
    double normal_squared = 0.0;
    Vec3 weights{0.0};
    double margin = 0.0;  // farther than this from 0 the sign of a weight is certain

    Foot(const Corners& corners, const Vec3& query) noexcept
        : start(corners[0] - query), ab(corners[1] - corners[0]), ac(corners[2] - corners[0]) {
        // Ericson 2005, section 5.1.5, with areas from cross products instead of Gram determinants,
        // which lose twice the digits in a needle.
        const Vec3 normal = glm::cross(ab, ac);
        normal_squared = glm::dot(normal, normal);
        const double to_b = glm::dot(normal, glm::cross(ac, start));
        const double to_c = glm::dot(normal, glm::cross(start, ab));
        weights = {normal_squared - to_b - to_c, to_b, to_c};
        // With edges no longer than L and a normal n they are off by less than 2^-50 of L^3 h (a
        // normal tilted by rounding, times the height h of the point) and of L |n| |start| (their
        // own rounding). Nearer to an edge than four times that the edge is as good an answer.
        constexpr double kRounding = 0x1p-48;
        const double length = std::max(size_of(ab), size_of(ac));
        const double normal_length = std::sqrt(normal_squared);
        const double height = std::abs(glm::dot(normal, start)) / normal_length;
        margin = kRounding * length * (length * length * height + size_of(start) * normal_length);
    }
};

Candidate closest_of(const Corners& corners, const Vec3& query) noexcept {
    const Foot foot(corners, query);
    const double min_weight = std::min({foot.weights.x, foot.weights.y, foot.weights.z});
    Candidate best;
    if (min_weight > foot.margin) {
        best.weights = foot.weights / foot.normal_squared;
        best.offset = foot.start + best.weights.y * foot.ab + best.weights.z * foot.ac;
        return best;
    }
    // From outside, an edge with the triangle on its near side is not nearest. Without area the
    // margin is 0 or not a number, and all edges are tried.
    const bool is_outside = min_weight < -foot.margin;
    double min_squared = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        if (is_outside && foot.weights[(i + 2) % 3] > foot.margin) {
            continue;
        }
        const Candidate other = on_edge(corners, query, i);
        const double squared = glm::dot(other.offset, other.offset);
        if (squared < min_squared) {
            best = other;
            min_squared = squared;
        }
    }
    return best;
}

Vec3 point_at(const Corners& corners, const Vec3& weights) noexcept {
    return weights.x * corners[0] + (weights.y * corners[1] + weights.z * corners[2]) +
           0.0;  // not -0
}

}  // namespace

std::optional<ClosestPoint> PreparedPoint::closest_point(const Vec3& a,
                                                         const Vec3& b,
                                                         const Vec3& c,
                                                         double max_distance) const noexcept {
    double squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = std::min(std::min(a[axis], b[axis]), c[axis]);
        const double upper = std::max(std::max(a[axis], b[axis]), c[axis]);
        squared += squared_gap(lower, upper, axis);
    }
    const double own = kShrink * std::sqrt(squared);
    if (!(own <= max_distance)) {
        return std::nullopt;
    }
    const Corners corners{a, b, c};
    const Candidate best = closest_of(corners, point_);
    const double distance = std::max(own, std::sqrt(glm::dot(best.offset, best.offset)));
    if (!(distance <= max_distance)) {
        return std::nullopt;
    }
    return ClosestPoint{
        .distance = distance, .point = point_at(corners, best.weights), .weights = best.weights};
}

}  // namespace earshot::geometry
