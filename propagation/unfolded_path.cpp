// SPDX-License-Identifier: MIT
#include "earshot/propagation/unfolded_path.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/segment_distance.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace earshot::propagation {

using geometry::Plane;
using geometry::TriangleId;
using geometry::Vec3;

FacetTable::FacetTable(const Simulator& simulator, Executor& executor)
    : of_triangle_(simulator.facet_of_triangle(executor)) {
    const geometry::Facets& facets = simulator.scene_view(executor).facets;
    for (const geometry::Facet& facet : facets.facets) {
        planes_.push_back(facet.plane);
    }
    first_triangle_.assign(planes_.size(), 0);
    for (std::size_t i = of_triangle_.size(); i-- > 0;) {
        if (of_triangle_[i] != Simulator::kNoFacet) {
            first_triangle_[of_triangle_[i]] = static_cast<TriangleId>(i);
        }
    }
}

FacetTable::FacetTable(std::span<const FacetTriangle> triangles) {
    for (const FacetTriangle& triangle : triangles) {
        EARSHOT_ASSERT(triangles_.empty() || triangles_.back() < triangle.triangle);
        triangles_.push_back(triangle.triangle);
        of_triangle_.push_back(static_cast<geometry::FacetId>(planes_.size()));
        first_triangle_.push_back(triangle.first_triangle);
        planes_.push_back(triangle.plane);
    }
}

geometry::FacetId FacetTable::facet_of(TriangleId triangle) const {
    if (triangles_.empty()) {
        return of_triangle_[triangle];
    }
    const auto found = std::lower_bound(triangles_.begin(), triangles_.end(), triangle);
    EARSHOT_ASSERT(found != triangles_.end() && *found == triangle);
    return of_triangle_[static_cast<std::size_t>(found - triangles_.begin())];
}

TriangleId FacetTable::first_triangle(TriangleId triangle) const {
    return first_triangle_[facet_of(triangle)];
}

const Plane& FacetTable::plane(TriangleId triangle) const {
    return planes_[facet_of(triangle)];
}

namespace {

enum class Interaction : std::int64_t { reflection, transmission, edge };

/// Which of the path's interactions is at its edge: its point lies on the edge, and its facet
/// contains it. At an end of the edge the point of a reflection may lie on it, too; only then the
/// facets decide, for a table made of paths may have another plane through the edge's triangle.
std::size_t edge_interaction(const Path& path, const FacetTable& facets) {
    constexpr double kPointWeight = 1e6;
    const std::array<Vec3, 2>& edge = path.edges.front();
    std::size_t nearest = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < path.triangles.size(); ++i) {
        const Plane& plane = facets.plane(path.triangles[i]);
        const double away = kPointWeight * distance_to_segment(path.points[i + 1], edge) +
                            std::abs(plane.distance(edge[0])) + std::abs(plane.distance(edge[1]));
        if (away < distance) {
            distance = away;
            nearest = i;
        }
    }
    return nearest;
}

std::vector<Interaction> interactions_of(const Path& path, const FacetTable& facets) {
    std::vector<Interaction> interactions(path.triangles.size(), Interaction::reflection);
    for (std::size_t i = 0; i < path.transmitted.size(); ++i) {
        if (path.transmitted[i] != 0) {
            interactions[i] = Interaction::transmission;
        }
    }
    if (!path.edges.empty()) {
        interactions[edge_interaction(path, facets)] = Interaction::edge;
    }
    return interactions;
}

// The part of an edge that takes part moves with the source; its line does not. Numbers of the line
// differ by rounding from instant to instant, those of other edges by more than this.
constexpr double kLineResolution = 1e-3;

/// The direction of a line and its point that is closest to the origin, rounded.
void add_line(const std::array<Vec3, 2>& segment, std::vector<std::int64_t>& elements) {
    Vec3 direction = geometry::direction_between(segment[0], segment[1]);
    const double largest = geometry::max_abs(direction);
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(direction[axis]) == largest) {
            direction = direction[axis] < 0.0 ? -direction : direction;
            break;
        }
    }
    const Vec3 foot = segment[0] - glm::dot(segment[0], direction) * direction;
    for (const Vec3& numbers : {direction, foot}) {
        for (int axis = 0; axis < 3; ++axis) {
            elements.push_back(
                static_cast<std::int64_t>(std::floor(numbers[axis] / kLineResolution + 0.5)));
        }
    }
}

/// first, then the mirror of a plane.
AffineMap mirrored(const AffineMap& first, const Plane& plane) {
    const glm::dmat3 mirror = glm::dmat3(1.0) - 2.0 * glm::outerProduct(plane.normal, plane.normal);
    return {.linear = mirror * first.linear,
            .offset = mirror * first.offset + 2.0 * plane.offset * plane.normal};
}

/// What a map, which keeps lengths, takes to `point`.
Vec3 undone(const AffineMap& map, const Vec3& point) {
    return glm::transpose(map.linear) * (point - map.offset);
}

}  // namespace

namespace {

// Normals at right angles but for rounding, that of planes which follow from the points of paths
// included. Images in either order differ by 2 nm per metre at most.
constexpr double kMaxCosine = 1e-9;

/// Whether the order of two interactions that follow each other makes no difference to the image:
/// the planes of two reflections are at right angles.
bool commute(const Path& path,
             const std::vector<Interaction>& interactions,
             const FacetTable& facets,
             std::size_t a,
             std::size_t b) {
    return interactions[a] == Interaction::reflection &&
           interactions[b] == Interaction::reflection &&
           std::abs(glm::dot(facets.plane(path.triangles[a]).normal,
                             facets.plane(path.triangles[b]).normal)) <= kMaxCosine;
}

/// The interactions in the order that all paths to one image share, whose walls a source that moves
/// meets now in one order and now in another: again and again the lowest facet that can be met
/// next.
std::vector<std::size_t> common_order(const Path& path,
                                      const std::vector<Interaction>& interactions,
                                      const FacetTable& facets) {
    std::vector<std::size_t> left(interactions.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    std::vector<std::size_t> order;
    while (!left.empty()) {
        std::size_t next = 0;
        for (std::size_t k = 1; k < left.size(); ++k) {
            const bool can_be_next = std::all_of(
                left.begin(), left.begin() + static_cast<std::ptrdiff_t>(k), [&](std::size_t i) {
                    return commute(path, interactions, facets, i, left[k]);
                });
            if (can_be_next && facets.first_triangle(path.triangles[left[k]]) <
                                   facets.first_triangle(path.triangles[left[next]])) {
                next = k;
            }
        }
        order.push_back(left[next]);
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(next));
    }
    return order;
}

}  // namespace

PathKey path_key(const Path& path, const FacetTable& facets) {
    PathKey key;
    const std::vector<Interaction> interactions = interactions_of(path, facets);
    for (const std::size_t i : common_order(path, interactions, facets)) {
        key.elements.push_back(static_cast<std::int64_t>(interactions[i]));
        if (interactions[i] != Interaction::edge) {
            key.elements.push_back(facets.first_triangle(path.triangles[i]));
        }
    }
    if (!path.edges.empty()) {
        add_line(path.edges.front(), key.elements);
    }
    return key;
}

UnfoldedPath unfold(const Path& path, const FacetTable& facets) {
    UnfoldedPath unfolded;
    const std::vector<Interaction> interactions = interactions_of(path, facets);
    for (std::size_t i = 0; i < interactions.size(); ++i) {
        if (interactions[i] == Interaction::edge) {
            unfolded.has_edge = true;
            unfolded.edge = path.edges.front();
        } else if (interactions[i] == Interaction::reflection) {
            AffineMap& map = unfolded.has_edge ? unfolded.after : unfolded.before;
            map = mirrored(map, facets.plane(path.triangles[i]));
        }
    }
    return unfolded;
}

namespace {

/// The place along an edge, 0 ... 1, over which the way between two points is shortest: where it
/// makes equal angles with the edge, if that is on it.
double apex_of(const std::array<Vec3, 2>& edge, const Vec3& from, const Vec3& to) {
    const Vec3 along = edge[1] - edge[0];
    const double squared = glm::dot(along, along);
    if (!(squared > 0.0)) {
        return 0.0;
    }
    const double u_from = glm::dot(from - edge[0], along) / squared;
    const double u_to = glm::dot(to - edge[0], along) / squared;
    const double d_from = glm::distance(from, edge[0] + u_from * along);
    const double d_to = glm::distance(to, edge[0] + u_to * along);
    const double sum = d_from + d_to;
    const double apex = sum > 0.0 ? (u_from * d_to + u_to * d_from) / sum : u_from;
    return std::clamp(apex, 0.0, 1.0);
}

}  // namespace

MovingLength length_of(const MovingUnfoldedPath& path,
                       const Motion& source,
                       const Motion& listener) {
    const UnfoldedPath& value = path.value;
    const UnfoldedPath& rate = path.rate;
    const Vec3 image = value.before(source.position);
    const Vec3 image_velocity =
        value.before.linear * source.velocity + rate.before(source.position);
    if (!value.has_edge) {
        const Vec3 arrival = geometry::direction_between(image, listener.position);
        return {.length = glm::distance(image, listener.position),
                .rate_by_source = -glm::dot(arrival, image_velocity),
                .rate_by_listener = glm::dot(arrival, listener.velocity),
                .arrival = arrival};
    }
    // The shortest way does not get longer, to first order, as its apex moves along the edge.
    const double u = apex_of(value.edge, image, undone(value.after, listener.position));
    const Vec3 apex = value.edge[0] + u * (value.edge[1] - value.edge[0]);
    const Vec3 apex_velocity = rate.edge[0] + u * (rate.edge[1] - rate.edge[0]);
    const Vec3 apex_image = value.after(apex);
    const Vec3 apex_image_velocity = value.after.linear * apex_velocity + rate.after(apex);
    const Vec3 departure = geometry::direction_between(image, apex);
    const Vec3 arrival = geometry::direction_between(apex_image, listener.position);
    return {.length = glm::distance(image, apex) + glm::distance(apex_image, listener.position),
            .rate_by_source = glm::dot(departure, apex_velocity - image_velocity) -
                              glm::dot(arrival, apex_image_velocity),
            .rate_by_listener = glm::dot(arrival, listener.velocity),
            .arrival = arrival};
}

}  // namespace earshot::propagation
