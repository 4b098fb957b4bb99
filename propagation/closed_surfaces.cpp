// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/closed_surfaces.h"

#include "earshot/geometry/clean.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/topology.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace earshot::propagation {
namespace {

using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;

/// The triangles with three different vertices, by welded vertices.
struct WeldedTriangles {
    std::vector<Triangle> triangles;
    std::vector<TriangleId> original;
};

WeldedTriangles welded(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
    const geometry::CleanMesh clean = geometry::clean({positions, triangles});
    WeldedTriangles result;
    for (TriangleId t = 0; t < triangles.size(); ++t) {
        const Triangle corners = {
            clean.weld[triangles[t][0]], clean.weld[triangles[t][1]], clean.weld[triangles[t][2]]};
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) {
            result.triangles.push_back(corners);
            result.original.push_back(t);
        }
    }
    return result;
}

void enclose(ClosedSurface& surface,
             std::span<const Vec3> positions,
             std::span<const Triangle> triangles) {
    surface.lower = surface.upper = positions[triangles[surface.triangles.front()][0]];
    for (const TriangleId t : surface.triangles) {
        for (const geometry::VertexId vertex : triangles[t]) {
            surface.lower = glm::min(surface.lower, positions[vertex]);
            surface.upper = glm::max(surface.upper, positions[vertex]);
        }
    }
}

}  // namespace

std::vector<ClosedSurface> closed_surfaces(std::span<const Vec3> positions,
                                           std::span<const Triangle> triangles) {
    const WeldedTriangles mesh = welded(positions, triangles);
    const geometry::EdgeTable edges(mesh.triangles, positions.size());
    // Connect the triangles of each edge.
    geometry::DisjointSets sets(mesh.triangles.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        for (const geometry::HalfEdgeId h : uses) {
            sets.unite(geometry::triangle_of(uses.front()), geometry::triangle_of(h));
        }
    }
    // A set with an edge of an odd number of triangles has a border.
    std::vector<bool> has_border(mesh.triangles.size(), false);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges.uses(e).size() % 2 != 0) {
            has_border[sets.find(geometry::triangle_of(edges.uses(e).front()))] = true;
        }
    }
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::vector<std::size_t> surface_of(mesh.triangles.size(), kNone);
    std::vector<ClosedSurface> surfaces;
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        const TriangleId root = sets.find(t);
        if (has_border[root]) {
            continue;
        }
        if (surface_of[root] == kNone) {
            surface_of[root] = surfaces.size();
            surfaces.emplace_back();
        }
        surfaces[surface_of[root]].triangles.push_back(mesh.original[t]);
    }
    for (ClosedSurface& surface : surfaces) {
        enclose(surface, positions, triangles);
    }
    return surfaces;
}

bool is_inside(const ClosedSurface& surface,
               std::span<const Vec3> positions,
               std::span<const Triangle> triangles,
               const Vec3& point) {
    const bool in_box = glm::all(glm::greaterThanEqual(point, surface.lower)) &&
                        glm::all(glm::lessThanEqual(point, surface.upper));
    if (!in_box) {
        return false;
    }
    // Directions without a relation to the axes, in which models have their edges.
    constexpr std::array<std::array<double, 3>, 3> kDirections{
        {{0.5377, 0.3219, 0.7793}, {-0.2861, 0.9127, -0.2919}, {-0.7341, -0.4513, 0.5073}}};
    const Vec3 farthest = glm::max(glm::abs(surface.lower), glm::abs(surface.upper));
    const double max_abs_coordinate = std::max({farthest.x, farthest.y, farthest.z});
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    int votes = 0;
    for (const auto& [x, y, z] : kDirections) {
        const geometry::PreparedRay ray({.origin = point, .direction = {x, y, z}},
                                        max_abs_coordinate);
        bool odd = false;
        for (const TriangleId t : surface.triangles) {
            const auto [a, b, c] = geometry::corners(positions, triangles[t]);
            odd ^= ray.hit(a, b, c, kInfinity).has_value();
        }
        votes += odd ? 1 : 0;
    }
    return votes >= 2;
}

bool is_on(const ClosedSurface& surface,
           std::span<const Vec3> positions,
           std::span<const Triangle> triangles,
           const Vec3& point,
           double tolerance) {
    const geometry::PreparedPoint prepared(point);
    return std::any_of(surface.triangles.begin(), surface.triangles.end(), [&](TriangleId t) {
        const auto& [i, j, k] = triangles[t];
        const Vec3 &a = positions[i], &b = positions[j], &c = positions[k];
        // Most triangles are far off by their boxes.
        const Vec3 lower = glm::min(glm::min(a, b), c) - tolerance;
        const Vec3 upper = glm::max(glm::max(a, b), c) + tolerance;
        return glm::all(glm::greaterThanEqual(point, lower)) &&
               glm::all(glm::lessThanEqual(point, upper)) &&
               prepared.closest_point(a, b, c, tolerance).has_value();
    });
}

}  // namespace earshot::propagation
