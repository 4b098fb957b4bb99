// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/edge_counts.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/internal/point_tree.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/geometry/topology.h"

#include <glm/geometric.hpp>

#include <utility>
#include <vector>

namespace earshot::geometry {
namespace {

using Edge = std::pair<VertexId, VertexId>;

/// Connected components of the graph that the edges make.
std::size_t count_components(std::span<const Edge> edges, std::size_t vertex_count) {
    DisjointSets sets(vertex_count);
    std::size_t joined = 0;
    std::vector<bool> seen(vertex_count, false);
    std::size_t vertices = 0;
    for (const auto& [a, b] : edges) {
        for (const VertexId v : {a, b}) {
            vertices += seen[v] ? 0 : 1;
            seen[v] = true;
        }
        joined += sets.unite(a, b) ? 1 : 0;
    }
    return vertices - joined;
}

/// Within `tolerance` of the segment, but not of its ends.
bool lies_inside(const Vec3& point, const Segment& segment, double tolerance) noexcept {
    const Vec3 along = segment.to - segment.from;
    const Vec3 from = point - segment.from;
    const Vec3 to = point - segment.to;
    const double limit = tolerance * tolerance;
    const Vec3 normal = glm::cross(from, along);
    return glm::dot(from, along) > 0.0 && glm::dot(to, along) < 0.0 &&
           glm::dot(from, from) > limit && glm::dot(to, to) > limit &&
           glm::dot(normal, normal) <= limit * glm::dot(along, along);
}

std::vector<VertexId> t_junctions_of(std::span<const Edge> open_edges,
                                     std::span<const Vec3> positions,
                                     double tolerance) {
    std::vector<bool> is_end(positions.size(), false);
    std::vector<PointTree::Point> ends;
    for (const auto& [a, b] : open_edges) {
        for (const VertexId v : {a, b}) {
            if (!is_end[v]) {
                is_end[v] = true;
                ends.push_back({positions[v], v});
            }
        }
    }
    const PointTree tree(std::move(ends));
    std::vector<bool> is_junction(positions.size(), false);
    std::vector<VertexId> junctions;
    for (const auto& [a, b] : open_edges) {
        const Segment edge{positions[a], positions[b]};
        tree.near_segment(edge, tolerance, [&](const PointTree::Point& point) {
            if (!is_junction[point.vertex] && lies_inside(point.position, edge, tolerance)) {
                is_junction[point.vertex] = true;
                junctions.push_back(point.vertex);
            }
        });
    }
    return junctions;
}

std::vector<Edge> open_edges_of(const EdgeTable& edges, std::span<const Triangle> triangles) {
    std::vector<Edge> open;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const std::span<const HalfEdgeId> uses = edges.uses(e);
        if (uses.size() == 1) {
            open.emplace_back(start_of(triangles, uses[0]), end_of(triangles, uses[0]));
        }
    }
    return open;
}

}  // namespace

void count_edges(std::span<const Triangle> triangles,
                 std::span<const Vec3> positions,
                 CleanReport& report) {
    const EdgeTable edges(triangles, positions.size());
    const std::vector<Edge> open = open_edges_of(edges, triangles);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        report.non_manifold_edges += edges.uses(e).size() > 2 ? 1 : 0;
    }
    report.open_edges = open.size();
    report.holes = count_components(open, positions.size());
    const double tolerance = coplanar_tolerance({positions, triangles});
    report.t_junctions = t_junctions_of(open, positions, tolerance).size();
}

std::vector<VertexId> find_t_junctions(std::span<const Triangle> triangles,
                                       std::span<const Vec3> positions) {
    const EdgeTable edges(triangles, positions.size());
    return t_junctions_of(
        open_edges_of(edges, triangles), positions, coplanar_tolerance({positions, triangles}));
}

}  // namespace earshot::geometry
