// SPDX-License-Identifier: MIT
#include "earshot/collision/penetration.h"

#include "earshot/collision/narrow_phase/internal/leaf_pairs.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// The shortest translation of `moved` along the normal of `face` to one side of its plane. Empty
/// if `face` has no area.
std::optional<PairDepth> depth_in(const Corners& face, const Corners& moved) noexcept {
    const Vec3 normal = glm::cross(face[1] - face[0], face[2] - face[0]);
    const double length = glm::length(normal);
    if (!(length > 0.0)) {
        return std::nullopt;
    }
    const Vec3 unit = normal / length;
    double low = 0.0;
    double high = 0.0;
    for (const Vec3& corner : moved) {
        const double height = glm::dot(unit, corner - face[0]);
        low = std::min(low, height);
        high = std::max(high, height);
    }
    return -low < high ? PairDepth{-low, -low * unit} : PairDepth{high, -high * unit};
}

}  // namespace

std::optional<PairDepth> depth(const Corners& one, const Corners& other) noexcept {
    const auto first = depth_in(other, one);
    auto second = depth_in(one, other);
    if (second) {
        second->move = -second->move;
    }
    if (!first || !second) {
        return first ? first : second;
    }
    return second->depth < first->depth ? second : first;
}

std::optional<Penetration> deepest_penetration(const Body& a,
                                               const Body& b,
                                               std::span<const TrianglePair> contacts) {
    std::optional<Penetration> deepest;
    for (const TrianglePair& pair : contacts) {
        const auto here = depth(corners_of(a, pair.a), corners_of(b, pair.b));
        if (here && (!deepest || here->depth > deepest->depth.depth ||
                     (here->depth == deepest->depth.depth && pair < deepest->triangles))) {
            deepest = Penetration{pair, *here, {}};
        }
    }
    if (deepest) {
        const auto cut =
            intersection(corners_of(a, deepest->triangles.a), corners_of(b, deepest->triangles.b));
        deepest->cut = cut.value_or(geometry::Segment{});
    }
    return deepest;
}

}  // namespace earshot::collision
