// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/separation.h"

#include "earshot/geometry/intersect.h"
#include "earshot/geometry/overlap.h"
#include "earshot/geometry/predicates.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <map>

namespace earshot::propagation {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

enum class Crossing { none, proper, through_border, start_on_triangle };

/// How the segment from p to q, whose end lies on no triangle, crosses a triangle.
Crossing crossing_of(const Vec3& p, const Vec3& q, const geometry::Corners& t) {
    const int at_p = geometry::orient3d(t[0], t[1], t[2], p);
    const int at_q = geometry::orient3d(t[0], t[1], t[2], q);
    if (at_p * at_q > 0) {
        return Crossing::none;
    }
    if (at_q == 0) {
        return Crossing::through_border;  // in its plane: not a segment to decide by
    }
    std::array<int, 3> sides{};
    for (std::size_t k = 0; k < 3; ++k) {
        sides[k] = geometry::orient3d(p, q, t[k], t[(k + 1) % 3]);
    }
    const auto [low, high] = std::minmax_element(sides.begin(), sides.end());
    if (*low < 0 && *high > 0) {
        return Crossing::none;
    }
    if (at_p == 0) {
        return Crossing::start_on_triangle;
    }
    return *low == 0 || *high == 0 ? Crossing::through_border : Crossing::proper;
}

bool contains(const std::vector<std::uint32_t>& ascending, std::uint32_t value) {
    return std::binary_search(ascending.begin(), ascending.end(), value);
}

}  // namespace

Separation::Separation(const bvh::MeshBvh& bvh, std::span<const std::uint32_t> surface_of_triangle)
    : bvh_(bvh), surface_of_triangle_(surface_of_triangle) {}

bool Separation::add_crossings(const geometry::Segment& segment, Enclosure& enclosure) const {
    const geometry::SlabTest slab_test(
        segment.from, segment.to - segment.from, bvh_.max_abs_coordinate());
    std::map<std::uint32_t, bool> is_odd;
    std::vector<std::uint32_t> touched;
    bool is_decided = true;
    bvh_.traverse(
        [&](const geometry::Aabb& box) { return !slab_test.interval(box, 1.0).is_empty(); },
        [&](TriangleId id) {
            const std::uint32_t surface = surface_of_triangle_[id];
            if (surface == kNone) {
                return true;
            }
            switch (crossing_of(segment.from, segment.to, bvh_.corners(id))) {
                case Crossing::none:
                    break;
                case Crossing::proper:
                    is_odd[surface] = !is_odd[surface];
                    break;
                case Crossing::start_on_triangle:
                    touched.push_back(surface);
                    break;
                case Crossing::through_border:
                    is_decided = false;
                    break;
            }
            return is_decided;
        });
    if (!is_decided) {
        return false;
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    enclosure.on_surface = touched;
    for (const auto& [surface, odd] : is_odd) {
        if (odd && !contains(touched, surface)) {
            enclosure.inside.push_back(surface);
        }
    }
    return true;
}

std::optional<Separation::Enclosure> Separation::enclosure(const Vec3& point) const {
    // Directions without a relation to the axes, in which models have their edges.
    constexpr std::array<std::array<double, 3>, 6> kDirections{{{0.5377, 0.3219, 0.7793},
                                                                {-0.2861, 0.9127, -0.2919},
                                                                {-0.7341, -0.4513, 0.5073},
                                                                {0.1931, -0.6173, -0.7627},
                                                                {0.8713, -0.1237, 0.4751},
                                                                {-0.4219, 0.2683, 0.8661}}};
    const double reach =
        4.0 * (bvh_.max_abs_coordinate() + glm::length(point)) + 1.0;  // beyond all boxes
    for (const auto& [x, y, z] : kDirections) {
        Enclosure found;
        if (add_crossings({point, point + reach * Vec3(x, y, z)}, found)) {
            return found;
        }
    }
    return std::nullopt;
}

std::vector<TriangleId> Separation::separated(std::span<const TriangleId> candidates,
                                              std::span<const Vec3> points) const {
    // Surfaces that have all points inside, and those that have none there nor on them.
    std::map<std::uint32_t, std::size_t> points_inside;
    std::vector<std::uint32_t> touched;
    for (const Vec3& point : points) {
        const auto place = enclosure(point);
        if (!place) {
            return {};
        }
        for (const std::uint32_t surface : place->inside) {
            ++points_inside[surface];
        }
        touched.insert(touched.end(), place->on_surface.begin(), place->on_surface.end());
    }
    std::sort(touched.begin(), touched.end());
    std::vector<TriangleId> result;
    for (const TriangleId id : candidates) {
        const geometry::Corners corners = bvh_.corners(id);
        std::array<std::optional<Enclosure>, 3> places;
        for (std::size_t k = 0; k < 3; ++k) {
            places[k] = enclosure(corners[k]);
        }
        if (!places[0] || !places[1] || !places[2]) {
            continue;
        }
        // Surfaces that the triangle touches prove nothing about it.
        std::vector<std::uint32_t> near;
        for (const TriangleId other :
             bvh_.overlapping(geometry::TriangleRegion(corners[0], corners[1], corners[2]))) {
            near.push_back(surface_of_triangle_[other]);
        }
        std::sort(near.begin(), near.end());
        const auto parts = [&](std::uint32_t surface) {
            const std::size_t inside =
                points_inside.contains(surface) ? points_inside.at(surface) : 0;
            const bool triangle_inside = contains(places[0]->inside, surface);
            const bool is_whole = contains(places[1]->inside, surface) == triangle_inside &&
                                  contains(places[2]->inside, surface) == triangle_inside;
            return is_whole && !contains(near, surface) && !contains(touched, surface) &&
                   inside == (triangle_inside ? 0 : points.size());
        };
        bool is_separated = std::any_of(places[0]->inside.begin(),
                                        places[0]->inside.end(),
                                        [&](std::uint32_t surface) { return parts(surface); });
        for (const auto& [surface, count] : points_inside) {
            is_separated = is_separated || parts(surface);
        }
        if (is_separated) {
            result.push_back(id);
        }
    }
    return result;
}

}  // namespace earshot::propagation
