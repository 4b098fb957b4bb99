// SPDX-License-Identifier: MIT
#include "earshot/frustum/surface_points.h"

#include "earshot/base/math.h"
#include "earshot/frustum/internal/coincident_layers.h"
#include "earshot/geometry/closest_point.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace earshot::frustum {

using geometry::Facet;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// A moved point lies this far above a surface, as a share of the largest coordinate. A path of 64
/// reflections is up to 225 largest coordinates long; PathVerifier reflects points that are 8
/// roundings (2^-42) of that and more above a plane, and DuplicateTest tells paths apart whose
/// points differ by 64. 2^-27 is at least twice that for paths of up to 255 largest coordinates,
/// and a 64th of the tolerance (2^-21) that the coordinates of files have.
constexpr double kRelativeHeight = 0x1p-27;

/// A sheet ends at a point if a probe this many tolerances away in its plane is farther than half
/// as much from every triangle: that tells edges up to two tolerances away.
constexpr double kEdgeProbe = 4.0;
constexpr int kEdgeProbes = 32;

}  // namespace

/// The point must lie at least so far on one side of a plane.
struct SurfacePoints::Constraint {
    const Facet* facet = nullptr;
    double side = 1.0;
    double min_height = 0.0;
};

SurfacePoints::SurfacePoints(const SceneView& scene, double max_radius)
    : scene_(scene),
      min_height_(kRelativeHeight * std::max(scene.bvh.max_abs_coordinate(), max_radius)) {}

std::vector<TriangleId> SurfacePoints::triangles_at(const Vec3& point) const {
    return triangles_within(point, scene_.facets.tolerance);
}

std::vector<TriangleId> SurfacePoints::triangles_within(const Vec3& point, double distance) const {
    const geometry::PreparedPoint prepared(point);
    const double max_squared = geometry::PreparedPoint::squared_bound(distance);
    std::vector<TriangleId> found;
    scene_.bvh.traverse(
        [&](const geometry::Aabb& box) { return prepared.squared_distance(box) <= max_squared; },
        [&](TriangleId id) {
            const auto [a, b, c] = scene_.bvh.corners(id);
            if (prepared.closest_point(a, b, c, distance)) {
                found.push_back(id);
            }
            return true;
        });
    std::sort(found.begin(), found.end());
    return found;
}

Placement SurfacePoints::place(const Vec3& point,
                               std::span<const TriangleId> triangles,
                               const Vec3& other) const {
    std::vector<Constraint> constraints;
    TriangleId lowest = 0;
    for (const TriangleId triangle : triangles) {
        const Facet& facet = scene_.facets.facets[scene_.facets.of_triangle[triangle]];
        const double height = facet.plane.distance(point);
        const double other_height = facet.plane.distance(other);
        const double side = other_height > 0.0 ? 1.0 : -1.0;
        const double min_height = facet.deviation + min_height_;
        const bool is_told = std::abs(other_height) > facet.deviation + scene_.facets.tolerance;
        // Clear of the surface, on the right side.
        if ((is_told ? side * height : std::abs(height)) >= min_height) {
            continue;
        }
        if (!is_told) {
            return {point, PlacementProblem::other_point_in_plane, triangle};
        }
        if (constraints.empty()) {
            lowest = triangle;
        }
        constraints.push_back({&facet, side, min_height});
    }
    if (constraints.empty()) {
        return {point};
    }
    if (is_at_free_edge(point, *constraints.front().facet)) {
        return {point, PlacementProblem::edge_of_free_sheet, lowest};
    }
    return {move_off(point, constraints, other)};
}

// Projects the point onto the half-spaces in turn (Kaczmarz), which converges as the other point
// lies inside all of them. Where it converges slowly, in a sharp wedge, the point is moved towards
// the other.
Vec3 SurfacePoints::move_off(const Vec3& point,
                             std::span<const Constraint> constraints,
                             const Vec3& other) const {
    constexpr int kMaxRounds = 64;
    const auto missing = [&](const Constraint& constraint, const Vec3& at) {
        const double height = constraint.side * constraint.facet->plane.distance(at);
        return height < constraint.min_height ? constraint.min_height + min_height_ - height : 0.0;
    };
    Vec3 moved = point;
    for (int round = 0; round < kMaxRounds; ++round) {
        bool is_clear = true;
        for (const Constraint& constraint : constraints) {
            const double distance = missing(constraint, moved);
            moved += distance * constraint.side * constraint.facet->plane.normal;
            is_clear = is_clear && distance == 0.0;
        }
        if (is_clear) {
            return moved;
        }
    }
    double share = 0.0;
    for (const Constraint& constraint : constraints) {
        const double height = constraint.side * constraint.facet->plane.distance(point);
        const double other_height = constraint.side * constraint.facet->plane.distance(other);
        share = std::max(share, missing(constraint, point) / (other_height - height));
    }
    return point + share * (other - point);
}

// Only a sheet that meets no surface in another plane is free; probes in its plane tell whether it
// goes on in every direction.
bool SurfacePoints::is_at_free_edge(const Vec3& point, const Facet& sheet) const {
    const geometry::Facets& facets = scene_.facets;
    const double tolerance = facets.tolerance + sheet.deviation;
    const double radius = kEdgeProbe * tolerance;
    const std::vector<TriangleId> near = triangles_within(point, radius + tolerance);
    const Vec3& normal = sheet.plane.normal;
    for (const TriangleId triangle : near) {
        const Facet& facet = facets.facets[facets.of_triangle[triangle]];
        if (glm::length(glm::cross(facet.plane.normal, normal)) > kMaxLayerTilt) {
            return false;
        }
    }
    const Vec3 size = glm::abs(normal);
    const Vec3 axis = size.x <= size.y && size.x <= size.z ? Vec3(1.0, 0.0, 0.0)
                      : size.y <= size.z                   ? Vec3(0.0, 1.0, 0.0)
                                                           : Vec3(0.0, 0.0, 1.0);
    const Vec3 u = glm::normalize(glm::cross(normal, axis));
    const Vec3 v = glm::cross(normal, u);
    for (int i = 0; i < kEdgeProbes; ++i) {
        const double angle = 2.0 * math::kPi * i / kEdgeProbes;
        const Vec3 probe = point + radius * (math::cos(angle) * u + math::sin(angle) * v);
        const geometry::PreparedPoint prepared(probe);
        const bool goes_on = std::any_of(near.begin(), near.end(), [&](TriangleId id) {
            const auto [a, b, c] = scene_.bvh.corners(id);
            return prepared.closest_point(a, b, c, 0.5 * radius).has_value();
        });
        if (!goes_on) {
            return true;
        }
    }
    return false;
}

PlacedPairs place_pairs(const SceneView& scene,
                        const Vec3& source,
                        std::span<const Vec3> listeners) {
    double max_radius = glm::length(source);
    for (const Vec3& listener : listeners) {
        max_radius = std::max(max_radius, glm::length(listener));
    }
    const SurfacePoints surface_points(scene, max_radius);
    const std::vector<TriangleId> at_source = surface_points.triangles_at(source);
    PlacedPairs pairs;
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        const Placement from = surface_points.place(source, at_source, listeners[i]);
        const Placement to =
            surface_points.place(listeners[i], surface_points.triangles_at(listeners[i]), source);
        for (const Placement* placement : {&from, &to}) {
            if (placement->problem && !pairs.undecided) {
                pairs.undecided = {.is_source = placement == &from,
                                   .listener = i,
                                   .problem = *placement->problem,
                                   .triangle = placement->triangle};
            }
        }
        pairs.is_moved = pairs.is_moved || from.position != source || to.position != listeners[i];
        auto group =
            std::find_if(pairs.groups.begin(), pairs.groups.end(), [&](const auto& candidate) {
                return candidate.source == from.position;
            });
        if (group == pairs.groups.end()) {
            group = pairs.groups.insert(group, PlacedListeners{from.position, {}, {}});
        }
        group->numbers.push_back(i);
        group->positions.push_back(to.position);
    }
    return pairs;
}

PlacedPairs pairs_in_the_air(const Vec3& source, std::span<const Vec3> listeners) {
    PlacedPairs pairs;
    if (!listeners.empty()) {
        PlacedListeners& group = pairs.groups.emplace_back();
        group.source = source;
        group.numbers.resize(listeners.size());
        std::iota(group.numbers.begin(), group.numbers.end(), std::size_t{0});
        group.positions.assign(listeners.begin(), listeners.end());
    }
    return pairs;
}

}  // namespace earshot::frustum
