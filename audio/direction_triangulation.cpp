// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/direction_triangulation.h"

#include "earshot/audio/internal/convex_hull.h"
#include "earshot/audio/internal/vector3.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace earshot::audio {

namespace {

using Corners = std::array<std::size_t, 3>;

// Directions closer than this are one.
constexpr double kMinSpacing = 1e-3;

// Sets whose directions lie this close to one plane have no triangles.
constexpr double kMinHeight = 0.02;

// A triangle covers a hole of the set if its circumscribed circle is larger than 30 degrees and
// four times that of the middle one, or nearly a half of the sphere. The same goes for the edges of
// a ring of directions.
constexpr double kDegree = math::kPi / 180.0;
constexpr double kHoleRadius = 30.0 * kDegree;
constexpr double kMaxRadius = 85.0 * kDegree;
constexpr double kMaxEdge = 135.0 * kDegree;
constexpr double kHoleFactor = 4.0;

// A direction counts as the given one within this distance.
constexpr double kSameDirection = 1e-6;

// Rounding of barycentric weights on an edge between two triangles.
constexpr double kWeightTolerance = 1e-9;

double angle_between(const Direction& a, const Direction& b) {
    return 2.0 * math::asin(std::min(1.0, 0.5 * length(difference(a, b))));
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<long>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Indices of directions that no earlier one is close to.
std::vector<std::size_t> distinct_directions(std::span<const Direction> directions) {
    std::vector<std::size_t> distinct;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const bool is_new = std::all_of(distinct.begin(), distinct.end(), [&](std::size_t j) {
            return length(difference(directions[i], directions[j])) >= kMinSpacing;
        });
        if (is_new) {
            distinct.push_back(i);
        }
    }
    return distinct;
}

// Angle between the axis of the circle through three directions and each of them.
double circumscribed_radius(const Direction& a, const Direction& b, const Direction& c) {
    const Direction normal = cross(difference(b, a), difference(c, a));
    return math::acos(std::clamp(dot(normal, a) / length(normal), -1.0, 1.0));
}

// Van Oosterom and Strackee 1983.
double solid_angle_of(const Direction& a, const Direction& b, const Direction& c) {
    return 2.0 * math::atan2(dot(a, cross(b, c)), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
}

}  // namespace

DirectionTriangulation::DirectionTriangulation(std::span<const Direction> directions)
    : directions_(directions.begin(), directions.end()), solid_angles_(directions.size(), 0.0) {
    EARSHOT_ASSERT(!directions.empty());
    const std::vector<std::size_t> distinct = distinct_directions(directions);
    std::vector<Direction> points;
    for (const std::size_t i : distinct) {
        points.push_back(directions[i]);
    }
    std::vector<Corners> hull = convex_hull(points, kMinHeight);
    if (hull.empty()) {
        add_ring(distinct);
        return;
    }
    for (Corners& corners : hull) {
        corners = {distinct[corners[0]], distinct[corners[1]], distinct[corners[2]]};
    }
    add_triangles(hull);
}

// Keeps the triangles that cover no hole, and the edges between the others and them.
void DirectionTriangulation::add_triangles(std::span<const Corners> hull) {
    std::vector<double> radii;
    for (const auto& [a, b, c] : hull) {
        radii.push_back(circumscribed_radius(directions_[a], directions_[b], directions_[c]));
    }
    const double limit = std::min(kMaxRadius, std::max(kHoleRadius, kHoleFactor * median(radii)));
    std::map<std::pair<std::size_t, std::size_t>, bool> edges_of_holes;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Direction& a = directions_[hull[i][0]];
        const Direction& b = directions_[hull[i][1]];
        const Direction& c = directions_[hull[i][2]];
        const double solid_angle = std::max(0.0, solid_angle_of(a, b, c));
        for (const std::size_t corner : hull[i]) {
            solid_angles_[corner] += solid_angle / 3.0;
        }
        if (radii[i] <= limit) {
            // Cramer's rule for direction = sum of weight times corner.
            const double volume = dot(a, cross(b, c));
            triangles_.push_back({hull[i],
                                  {scaled(cross(b, c), 1.0 / volume),
                                   scaled(cross(c, a), 1.0 / volume),
                                   scaled(cross(a, b), 1.0 / volume)}});
        } else {
            for (std::size_t k = 0; k < 3; ++k) {
                edges_of_holes[{hull[i][k], hull[i][(k + 1) % 3]}] = true;
            }
        }
    }
    // The neighbour has the edge the other way round.
    for (const Triangle& triangle : triangles_) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t from = triangle.corners[k];
            const std::size_t to = triangle.corners[(k + 1) % 3];
            if (edges_of_holes.count({to, from}) != 0) {
                border_.push_back({from, to});
            }
        }
    }
}

// Edges between neighbours of directions in one plane, in the order of their angles about its
// normal.
void DirectionTriangulation::add_ring(std::span<const std::size_t> distinct) {
    if (distinct.size() < 2) {
        return;
    }
    // A basis of the plane: towards the first direction's farthest one, and across.
    const Direction& first = directions_[distinct[0]];
    const auto farthest_by = [&](const auto& value) {
        return *std::max_element(distinct.begin(), distinct.end(), [&](auto i, auto j) {
            return value(directions_[i]) < value(directions_[j]);
        });
    };
    const Direction along = difference(
        directions_[farthest_by([&](const auto& d) { return length(difference(d, first)); })],
        first);
    const Direction across = difference(directions_[farthest_by([&](const auto& d) {
                                            return length(cross(along, difference(d, first)));
                                        })],
                                        first);
    const Direction normal = cross(along, across);
    const Direction third = cross(normal, along);
    Direction centre{};
    for (const std::size_t i : distinct) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            centre[axis] += directions_[i][axis] / static_cast<double>(distinct.size());
        }
    }
    std::vector<std::pair<double, std::size_t>> ring;
    for (const std::size_t i : distinct) {
        const Direction from_centre = difference(directions_[i], centre);
        ring.emplace_back(math::atan2(dot(third, from_centre) / std::max(1e-300, length(normal)),
                                      dot(along, from_centre)),
                          i);
    }
    std::sort(ring.begin(), ring.end());
    std::vector<double> lengths;
    const std::size_t edges = ring.size() == 2 ? 1 : ring.size();
    for (std::size_t k = 0; k < edges; ++k) {
        lengths.push_back(angle_between(directions_[ring[k].second],
                                        directions_[ring[(k + 1) % ring.size()].second]));
    }
    const double limit = std::min(kMaxEdge, std::max(kHoleRadius, kHoleFactor * median(lengths)));
    for (std::size_t k = 0; k < edges; ++k) {
        if (lengths[k] <= limit) {
            border_.push_back({ring[k].second, ring[(k + 1) % ring.size()].second});
        }
    }
}

DirectionWeights DirectionTriangulation::weights(const Direction& direction) const {
    const auto cosine = [&](std::size_t i) { return dot(directions_[i], direction); };
    std::size_t closest = 0;
    for (std::size_t i = 1; i < directions_.size(); ++i) {
        closest = cosine(i) > cosine(closest) ? i : closest;
    }
    const DirectionWeights alone{{closest, closest, closest}, {1.0, 0.0, 0.0}};
    if (length(difference(directions_[closest], direction)) <= kSameDirection) {
        return alone;
    }
    const std::optional<DirectionWeights> inside = weights_in_triangle(direction);
    return inside ? *inside : weights_on_border(direction, alone);
}

// The triangle whose smallest weight is the largest: on an edge, where rounding may leave both
// triangles slightly, one of them.
std::optional<DirectionWeights> DirectionTriangulation::weights_in_triangle(
    const Direction& direction) const {
    const Triangle* best = nullptr;
    double largest = -kWeightTolerance;
    for (const Triangle& triangle : triangles_) {
        const double smallest = std::min({dot(triangle.rows[0], direction),
                                          dot(triangle.rows[1], direction),
                                          dot(triangle.rows[2], direction)});
        if (smallest > largest) {
            largest = smallest;
            best = &triangle;
        }
    }
    if (best == nullptr) {
        return std::nullopt;
    }
    DirectionWeights result{best->corners, {}};
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        result.weight[k] = std::max(0.0, dot(best->rows[k], direction));
        sum += result.weight[k];
    }
    for (double& weight : result.weight) {
        weight /= sum;
    }
    return result;
}

// The closest point of the border's great arcs, or the closest direction if none is closer.
DirectionWeights DirectionTriangulation::weights_on_border(const Direction& direction,
                                                           const DirectionWeights& closest) const {
    DirectionWeights result = closest;
    double largest_cosine = dot(directions_[closest.index[0]], direction);
    for (const auto& [from, to] : border_) {
        const Direction& a = directions_[from];
        const Direction& b = directions_[to];
        const Direction axis = cross(a, b);
        const double axis_square = dot(axis, axis);
        // In the plane of the arc: direction = sum of weight times end, and what is across.
        const double weight_a = dot(cross(direction, b), axis) / axis_square;
        const double weight_b = dot(cross(a, direction), axis) / axis_square;
        if (weight_a <= 0.0 || weight_b <= 0.0) {
            continue;
        }
        const double sine = dot(direction, axis) / std::sqrt(axis_square);
        const double cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine));
        if (cosine > largest_cosine) {
            largest_cosine = cosine;
            const double sum = weight_a + weight_b;
            result = {{from, to, from}, {weight_a / sum, weight_b / sum, 0.0}};
        }
    }
    return result;
}

std::vector<double> DirectionTriangulation::sphere_shares() const {
    double sum = 0.0;
    for (const double solid_angle : solid_angles_) {
        sum += solid_angle;
    }
    std::vector<double> shares(directions_.size(), 1.0 / static_cast<double>(directions_.size()));
    if (sum > 0.0) {
        std::transform(solid_angles_.begin(), solid_angles_.end(), shares.begin(), [&](double s) {
            return s / sum;
        });
    }
    return shares;
}

}  // namespace earshot::audio
