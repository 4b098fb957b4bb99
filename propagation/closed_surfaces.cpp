// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/closed_surfaces.h"

#include "earshot/geometry/clean.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/topology.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace earshot::propagation {
namespace {

using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;

/// Disjoint sets of triangles (Tarjan 1975, path halving).
class TriangleSets {
public:
    explicit TriangleSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), TriangleId{0});
    }

    TriangleId find(TriangleId t) noexcept {
        while (parent_[t] != t) {
            parent_[t] = parent_[parent_[t]];
            t = parent_[t];
        }
        return t;
    }

    /// The smaller index stands for both.
    void unite(TriangleId a, TriangleId b) noexcept {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<TriangleId> parent_;
};

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

/// Whether the half-line from `origin` crosses the triangle (Moeller and Trumbore 1997).
bool crosses(const Vec3& origin, const Vec3& direction, const std::array<Vec3, 3>& corners) {
    const Vec3 edge1 = corners[1] - corners[0];
    const Vec3 edge2 = corners[2] - corners[0];
    const Vec3 p = glm::cross(direction, edge2);
    const double determinant = glm::dot(edge1, p);
    if (determinant == 0.0) {
        return false;
    }
    const Vec3 s = origin - corners[0];
    const double u = glm::dot(s, p) / determinant;
    const Vec3 q = glm::cross(s, edge1);
    const double v = glm::dot(direction, q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && glm::dot(edge2, q) / determinant > 0.0;
}

}  // namespace

std::vector<ClosedSurface> closed_surfaces(std::span<const Vec3> positions,
                                           std::span<const Triangle> triangles) {
    const WeldedTriangles mesh = welded(positions, triangles);
    const geometry::EdgeTable edges(mesh.triangles, positions.size());
    // Connect the triangles of each edge.
    TriangleSets sets(mesh.triangles.size());
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
    int votes = 0;
    for (const auto& [x, y, z] : kDirections) {
        bool odd = false;
        for (const TriangleId t : surface.triangles) {
            const Triangle& corner = triangles[t];
            odd ^= crosses(point,
                           Vec3(x, y, z),
                           {positions[corner[0]], positions[corner[1]], positions[corner[2]]});
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
