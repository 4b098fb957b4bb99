// SPDX-License-Identifier: MIT
#include "earshot/geometry/closest_point.h"

#include "earshot/geometry/intersect.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace earshot::geometry {
namespace {

/// A point of the triangle, and its offset from the point that is asked about.
struct Candidate {
    Vec3 offset{0.0};
    Vec3 weights{0.0};
};

bool is_before(const Vec3& a, const Vec3& b) noexcept {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Where between two points (0 ... 1) the origin is nearest; they are given relative to it.
double nearest_share(const Vec3& from, const Vec3& along) noexcept {
    const double length_squared = glm::dot(along, along);
    if (!(length_squared > 0.0)) {
        return 0.0;
    }
    return std::clamp(-glm::dot(from, along) / length_squared, 0.0, 1.0);
}

using Corners = std::array<Vec3, 3>;

/// The edge from corner i to the next.
Candidate on_edge(const Corners& corners, const Vec3& asked, int i) noexcept {
    int from = i;
    int to = (i + 1) % 3;
    const auto corner = [&](int k) -> const Vec3& { return corners[static_cast<std::size_t>(k)]; };
    if (is_before(corner(to), corner(from))) {
        std::swap(from, to);
    }
    const Vec3 start = corner(from) - asked;
    const Vec3 along = corner(to) - corner(from);
    const double share = nearest_share(start, along);
    Candidate found;
    found.offset = share == 1.0 ? corner(to) - asked : start + share * along;
    found.weights[from] = 1.0 - share;
    found.weights[to] = share;
    return found;
}

// The weights below are off by less than 2^-50 of L^3 h (a normal tilted by rounding, times the
// height h of the point) and of L |n| |start| (their own rounding), over n^2, with L the edges'
// length. Nearer to an edge than four times that the edge is as good an answer.
constexpr double kWeightRounding = 0x1p-48;

/// The foot of the perpendicular, if it lies clearly inside the triangle.
std::optional<Candidate> on_face(const Corners& corners, const Vec3& asked) noexcept {
    const Vec3 start = corners[0] - asked;
    const Vec3 ab = corners[1] - corners[0];
    const Vec3 ac = corners[2] - corners[0];
    const Vec3 normal = glm::cross(ab, ac);
    const double normal_squared = glm::dot(normal, normal);
    // Ericson 2005, section 5.1.5, with areas from cross products instead of Gram determinants,
    // which lose twice the digits in a needle.
    const double to_b = glm::dot(normal, glm::cross(ac, start)) / normal_squared;
    const double to_c = glm::dot(normal, glm::cross(start, ab)) / normal_squared;
    const double least = std::min({to_b, to_c, 1.0 - to_b - to_c});
    if (!(least > 0.0)) {  // also if there is no area
        return std::nullopt;
    }
    const double length_squared = std::max(glm::dot(ab, ab), glm::dot(ac, ac));
    const double length = std::sqrt(length_squared);
    const double normal_length = std::sqrt(normal_squared);
    const double height = std::abs(glm::dot(normal, start)) / normal_length;
    const double margin = kWeightRounding * length *
                          (length_squared * height / normal_squared +
                           std::sqrt(glm::dot(start, start)) / normal_length);
    if (!(least > margin)) {
        return std::nullopt;
    }
    return Candidate{.offset = start + to_b * ab + to_c * ac,
                     .weights = {1.0 - to_b - to_c, to_b, to_c}};
}

Candidate on_border(const Corners& corners, const Vec3& asked) noexcept {
    Candidate best = on_edge(corners, asked, 0);
    double least = glm::dot(best.offset, best.offset);
    for (int i = 1; i < 3; ++i) {
        const Candidate other = on_edge(corners, asked, i);
        const double squared = glm::dot(other.offset, other.offset);
        if (squared < least) {
            best = other;
            least = squared;
        }
    }
    return best;
}

Vec3 point_at(const Corners& corners, const Vec3& weights) noexcept {
    return weights.x * corners[0] + (weights.y * corners[1] + weights.z * corners[2]) +
           0.0;  // not -0
}

}  // namespace

std::optional<NearPoint> PreparedPoint::nearest(const Vec3& a,
                                                const Vec3& b,
                                                const Vec3& c,
                                                double most) const noexcept {
    const Corners corners{a, b, c};
    const auto inside = on_face(corners, point_);
    const Candidate best = inside ? *inside : on_border(corners, point_);
    const double distance = std::sqrt(glm::dot(best.offset, best.offset));
    if (!(distance <= most)) {
        return std::nullopt;
    }
    const double own = this->distance(triangle_box(a, b, c));
    NearPoint found{.distance = std::max(distance, own),
                    .point = point_at(corners, best.weights),
                    .weights = best.weights};
    return found.distance <= most ? std::optional(found) : std::nullopt;
}

}  // namespace earshot::geometry
