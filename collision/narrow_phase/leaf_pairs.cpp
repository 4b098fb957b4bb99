// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/leaf_pairs.h"

#include "earshot/collision/narrow_phase/internal/triangle_lanes.h"
#include "earshot/collision/narrow_phase/triangle_distance.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;

namespace {

glm::dvec2 flat(const Vec3& p, int axis) noexcept {
    return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

int side(const Vec3& a, const Vec3& b, const Vec3& c, int axis) noexcept {
    return geometry::orient2d(flat(a, axis), flat(b, axis), flat(c, axis));
}

bool has_area(const Corners& t) noexcept {
    return side(t[0], t[1], t[2], 0) != 0 || side(t[0], t[1], t[2], 1) != 0 ||
           side(t[0], t[1], t[2], 2) != 0;
}

/// Whether two triangles that share an edge overlap, given the third corner of each: they are
/// coplanar and on one side of the edge.
bool overlap_beside_edge(const Vec3& from,
                         const Vec3& to,
                         const Vec3& one,
                         const Vec3& other) noexcept {
    if (geometry::orient3d(from, to, one, other) != 0) {
        return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (const int here = side(from, to, one, axis); here != 0) {
            return side(from, to, other, axis) == here;
        }
    }
    return false;
}

/// The pairs of corners that are the same vertex.
struct SharedCorners {
    std::array<std::pair<std::size_t, std::size_t>, 9> pairs{};
    std::size_t count = 0;

    SharedCorners(const Triangle& one, const Triangle& other) noexcept {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (one[i] == other[k]) {
                    pairs[count++] = {i, k};
                }
            }
        }
    }
};

/// Whether two triangles of one mesh intersect beyond the features that they share, as
/// find_self_contacts() defines it. Exact.
bool intersect_beyond_shared_features(const Triangle& one_ids,
                                      const Corners& one,
                                      const Triangle& other_ids,
                                      const Corners& other) noexcept {
    const SharedCorners shared(one_ids, other_ids);
    if (shared.count == 0) {
        return intersect(one, other);
    }
    // Triangles with an area have three different vertices.
    if (!has_area(one) || !has_area(other)) {
        return false;
    }
    const auto [i, k] = shared.pairs[0];
    const Vec3& one_next = one[(i + 1) % 3];
    const Vec3& one_last = one[(i + 2) % 3];
    const Vec3& other_next = other[(k + 1) % 3];
    const Vec3& other_last = other[(k + 2) % 3];
    if (shared.count == 1) {
        // Both are convex: with another common point they have the segment to it from the shared
        // corner in common, and its extension to where it leaves one of them, through the edge
        // opposite the corner.
        return geometry::touches({one_next, one_last}, other[0], other[1], other[2]) ||
               geometry::touches({other_next, other_last}, one[0], one[1], one[2]);
    }
    if (shared.count == 2) {
        const auto [i2, k2] = shared.pairs[1];
        return overlap_beside_edge(one[i], one[i2], one[3 - i - i2], other[3 - k - k2]);
    }
    return true;
}

Vec3 direction_between(const Corners& one, const Corners& other) noexcept {
    return geometry::normalized_or_zero(((other[0] - one[0]) + (other[1] - one[1])) +
                                        (other[2] - one[2]));
}

/// Whether a direction separates triangles by more than a distance, so that distance_of_disjoint()
/// would exceed it too.
bool separated_by(const Corners& one,
                  const Corners& other,
                  const Vec3& direction,
                  double distance) noexcept {
    double upper = 0.0;
    double lower = std::numeric_limits<double>::infinity();
    double size = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 in_one = one[i] - one[0];
        const Vec3 in_other = other[i] - one[0];
        upper = std::max(upper, glm::dot(direction, in_one));
        lower = std::min(lower, glm::dot(direction, in_other));
        size = std::max({size, glm::dot(in_one, in_one), glm::dot(in_other, in_other)});
    }
    // The gap is off by less than 2^-50 of the size, distances by less than 2^-42.
    constexpr double kRounding = 0x1p-40;
    const double gap = lower - upper;
    return gap > distance && (gap - distance) * (gap - distance) > kRounding * kRounding * size;
}

}  // namespace

bool ContactSearch::intersect_leaves(const LeafPair& leaves) {
    ++statistics.elementary_tests;
    const Corners& one = a_.corners(leaves[0]);
    const Corners& other = b_.corners(leaves[1]);
    return query_ == Query::all_of_one_mesh
               ? intersect_beyond_shared_features(triangles_[a_.triangle(leaves[0])],
                                                  one,
                                                  triangles_[b_.triangle(leaves[1])],
                                                  other)
               : intersect(one, other);
}

void ContactSearch::decide_batch(std::span<const LeafPair> pairs) {
    TriangleLanes lanes;
    for (std::size_t i = 0; i < TriangleLanes::kWidth; ++i) {
        const LeafPair& pair = pairs[std::min(i, pairs.size() - 1)];
        lanes.set(i, a_.local_corners(pair[0]), b_.local_corners(pair[1]));
    }
    const LanesDecided decided = decide_lanes(lanes, a_.pose(), b_.pose());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if ((decided.disjoint >> i & 1U) == 0 &&
            ((decided.intersecting >> i & 1U) != 0 || intersect_leaves(pairs[i]))) {
            found.push_back({a_.triangle(pairs[i][0]), b_.triangle(pairs[i][1])});
        }
    }
}

void ContactSearch::decide() {
    const std::span<const LeafPair> pairs(batch_.data(), count_);
    count_ = 0;
    if (query_ == Query::all) {
        for (std::size_t i = 0; i < pairs.size(); i += TriangleLanes::kWidth) {
            decide_batch(pairs.subspan(i, std::min(TriangleLanes::kWidth, pairs.size() - i)));
        }
        return;
    }
    for (const LeafPair& pair : pairs) {
        if (intersect_leaves(pair)) {
            const geometry::TriangleId a = a_.triangle(pair[0]);
            const geometry::TriangleId b = b_.triangle(pair[1]);
            const bool is_in_order = query_ == Query::first || a < b;
            found.push_back(is_in_order ? TrianglePair{a, b} : TrianglePair{b, a});
        }
    }
}

void DistanceSearch::add(std::uint32_t a, std::uint32_t b) noexcept {
    ++statistics.triangle_pairs;
    const Corners& one = a_.corners(a);
    const Corners& other = b_.corners(b);
    // Close to the best pair most others are separated by more than its distance along its
    // direction, elsewhere along the direction between the triangles.
    if (separated_by(one, other, direction_, best.distance) ||
        separated_by(one, other, direction_between(one, other), best.distance)) {
        return;
    }
    ++statistics.elementary_tests;
    const TriangleDistance here = distance_of_disjoint(one, other);
    const TrianglePair pair{a_.triangle(a), b_.triangle(b)};
    if (here.distance < best.distance ||
        (here.distance == best.distance && pair < best.triangles)) {
        best = {here.distance, pair, here.on_one, here.on_other};
        // Triangles' distances may lie below the true ones by a rounding; the boxes' padding and
        // this factor are more. The summand stands for squares that underflow.
        constexpr double kGrow = 1.0 + 0x1p-20;
        squared_bound_ = geometry::round_up(kGrow * here.distance * here.distance + 0x1p-120);
        direction_ = geometry::normalized_or_zero(here.on_other - here.on_one);
    }
}

}  // namespace earshot::collision
