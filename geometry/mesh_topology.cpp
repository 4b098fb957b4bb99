// SPDX-License-Identifier: MIT
#include "earshot/geometry/mesh_topology.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/internal/edge_counts.h"
#include "earshot/geometry/internal/half_edge_mesh.h"
#include "earshot/geometry/internal/manifold_fans.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/geometry/topology.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace earshot::geometry {
namespace {

/// An outline has at least this share of its sheet's area. The rim of a hole in a closed room has
/// less than half of the area of the room's surface.
constexpr double kMinOutlineShare = 0.7;

double area_of(const Corners& corners) {
    return 0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
}

/// The clean triangles by welded vertices.
std::vector<Triangle> welded_triangles(const MeshView& mesh, const CleanMesh& clean) {
    std::vector<Triangle> triangles;
    triangles.reserve(clean.kept.size());
    for (const TriangleId id : clean.kept) {
        const auto& [a, b, c] = mesh.triangles[id];
        triangles.push_back({clean.weld[a], clean.weld[b], clean.weld[c]});
    }
    return triangles;
}

/// Finds the connected components of the triangles that `topology.clean` keeps.
void find_islands(const MeshView& mesh,
                  std::span<const Triangle> triangles,
                  MeshTopology& topology) {
    const std::vector<TriangleId>& kept = topology.clean.kept;
    const EdgeTable edges(triangles, mesh.positions.size());
    DisjointSets sets(triangles.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        for (const HalfEdgeId h : edges.uses(e)) {
            sets.unite(triangle_of(edges.uses(e).front()), triangle_of(h));
        }
    }
    topology.island_of_triangle.assign(mesh.triangles.size(), MeshTopology::kNoIsland);
    std::vector<std::uint32_t>& island_of = topology.island_of_triangle;
    for (TriangleId t = 0; t < triangles.size(); ++t) {
        const TriangleId root = sets.find(t);  // the lowest of the component
        if (root == t) {
            island_of[kept[t]] = static_cast<std::uint32_t>(topology.islands.size());
            const Vec3& corner = mesh.positions[triangles[t][0]];
            topology.islands.push_back(
                {.first_triangle = kept[t], .lower = corner, .upper = corner});
        }
        island_of[kept[t]] = island_of[kept[root]];
        Island& island = topology.islands[island_of[kept[t]]];
        ++island.triangles;
        for (const Vec3& corner : corners(mesh.positions, triangles[t])) {
            island.lower = glm::min(island.lower, corner);
            island.upper = glm::max(island.upper, corner);
        }
        island.area += area_of(corners(mesh.positions, triangles[t]));
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges.uses(e).size() % 2 != 0) {
            const TriangleId t = triangle_of(edges.uses(e).front());
            topology.islands[island_of[kept[t]]].is_closed = false;
        }
    }
}

/// Measures a border loop. `loop` holds half-edges of `fans`, opposite to the direction of the rim.
HoleLoop measured(std::span<const HalfEdgeId> loop,
                  const ManifoldFans& fans,
                  std::span<const Triangle> triangles,
                  std::span<const Vec3> positions) {
    HoleLoop hole;
    const auto welded_start = [&](HalfEdgeId h) {
        // In a turned triangle corners 1 and 2 are swapped.
        const HalfEdgeId corner = fans.is_flipped[triangle_of(h)] && h % 3 != 0 ? 3 - h % 3 : h % 3;
        return triangles[triangle_of(h)][corner];
    };
    for (const HalfEdgeId h : loop) {
        hole.rim.push_back(welded_start(next_in_triangle(h)));
        hole.open_edges += fans.uses_of_border[h] == 1 ? 1 : 0;
    }
    const Vec3 origin = positions[hole.rim.front()];
    hole.lower = hole.upper = origin;
    Vec3 vector_area(0.0);
    for (std::size_t i = 0; i < hole.rim.size(); ++i) {
        const Vec3& from = positions[hole.rim[i]];
        const Vec3& to = positions[hole.rim[(i + 1) % hole.rim.size()]];
        const double length = glm::length(to - from);
        hole.rim_length += length;
        hole.centre += length * (0.5 * (from - origin) + 0.5 * (to - origin));
        vector_area += 0.5 * glm::cross(from - origin, to - origin);
        hole.lower = glm::min(hole.lower, from);
        hole.upper = glm::max(hole.upper, from);
    }
    hole.centre = origin + hole.centre / hole.rim_length;
    hole.area = glm::length(vector_area);
    hole.normal = normalized_or_zero(vector_area);
    return hole;
}

/// Finds holes, flipped triangles, and whether islands are orientable.
void find_borders_of_patches(const MeshView& mesh,
                             std::span<const Triangle> triangles,
                             const ManifoldFans& fans,
                             MeshTopology& topology) {
    const HalfEdgeBorders borders = find_borders(fans.triangles, fans.vertex_count);
    const std::vector<TriangleId>& kept = topology.clean.kept;
    const auto island_of = [&](TriangleId t) { return topology.island_of_triangle[kept[t]]; };

    std::vector<std::size_t> loops_of_patch(fans.is_patch_orientable.size(), 0);
    std::vector<double> area_of_patch(loops_of_patch.size(), 0.0);
    for (TriangleId t = 0; t < triangles.size(); ++t) {
        area_of_patch[fans.patch[t]] += area_of(corners(mesh.positions, triangles[t]));
        if (fans.is_flipped[t]) {
            topology.flipped.push_back(kept[t]);
        }
        Island& island = topology.islands[island_of(t)];
        island.is_orientable = island.is_orientable && fans.is_patch_orientable[fans.patch[t]];
    }
    for (const auto& loop : borders.loops) {
        ++loops_of_patch[fans.patch[triangle_of(loop.front())]];
    }
    for (const auto& loop : borders.loops) {
        const TriangleId t = triangle_of(loop.front());
        HoleLoop hole = measured(loop, fans, triangles, mesh.positions);
        if (hole.open_edges > 0) {
            hole.island = island_of(t);
            hole.is_outline = loops_of_patch[fans.patch[t]] == 1 &&
                              hole.area > kMinOutlineShare * area_of_patch[fans.patch[t]];
            topology.holes.push_back(std::move(hole));
        }
    }
    std::sort(topology.holes.begin(), topology.holes.end(), [](const auto& a, const auto& b) {
        const VertexId lowest_a = *std::min_element(a.rim.begin(), a.rim.end());
        const VertexId lowest_b = *std::min_element(b.rim.begin(), b.rim.end());
        return a.island != b.island   ? a.island < b.island
               : lowest_a != lowest_b ? lowest_a < lowest_b
                                      : a.rim < b.rim;
    });
}

/// Counts vertices - edges + triangles of the fans per island.
void count_euler_characteristics(const MeshView& mesh,
                                 std::span<const Triangle> triangles,
                                 const ManifoldFans& fans,
                                 MeshTopology& topology) {
    const std::vector<TriangleId>& kept = topology.clean.kept;
    const auto island_of = [&](TriangleId t) -> Island& {
        return topology.islands[topology.island_of_triangle[kept[t]]];
    };
    std::vector<bool> is_counted(fans.vertex_count, false);
    std::vector<bool> is_welded_vertex(mesh.positions.size(), false);
    for (TriangleId t = 0; t < triangles.size(); ++t) {
        ++island_of(t).euler_characteristic;
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexId fan = fans.triangles[t][k];
            island_of(t).euler_characteristic += is_counted[fan] ? 0 : 1;
            is_counted[fan] = true;
            is_welded_vertex[triangles[t][k]] = true;
        }
    }
    topology.split_vertices =
        fans.vertex_count - static_cast<std::size_t>(
                                std::count(is_welded_vertex.begin(), is_welded_vertex.end(), true));
    const EdgeTable edges(fans.triangles, fans.vertex_count);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        --island_of(triangle_of(edges.uses(e).front())).euler_characteristic;
    }
}

/// Whether the fronts of two triangles at one place face opposite directions.
bool is_reversed(const MeshView& mesh, TriangleId a, TriangleId b) {
    const auto normal = [&](TriangleId t) {
        const auto [p, q, r] = corners(mesh, t);
        return glm::cross(q - p, r - p);
    };
    return glm::dot(normal(a), normal(b)) < 0.0;
}

void find_slivers(const MeshView& mesh, MeshTopology& topology) {
    for (const TriangleId id : topology.clean.kept) {
        const auto [a, b, c] = corners(mesh, id);
        const double longest =
            std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
        const double height = glm::length(glm::cross(b - a, c - a)) / longest;
        if (height < kMaxSliverHeight * longest) {
            topology.slivers.push_back(
                {.triangle = id, .height = height, .length = longest, .centre = (a + b + c) / 3.0});
        }
    }
}

}  // namespace

MeshTopology find_topology(const MeshView& mesh, Executor& executor) {
    MeshTopology topology;
    topology.clean = clean(mesh, executor);
    const std::vector<Triangle> triangles = welded_triangles(mesh, topology.clean);
    find_islands(mesh, triangles, topology);
    const ManifoldFans fans = split_fans(triangles, mesh.positions);
    find_borders_of_patches(mesh, triangles, fans, topology);
    count_euler_characteristics(mesh, triangles, fans, topology);
    for (const DuplicateTriangle& pair : topology.clean.duplicates) {
        topology.doubled.push_back({.first = pair.kept,
                                    .repeated = pair.duplicate,
                                    .is_reversed = is_reversed(mesh, pair.kept, pair.duplicate)});
    }
    for (const VertexId vertex : find_t_junctions(triangles, mesh.positions)) {
        topology.t_junctions.push_back({vertex, mesh.positions[vertex]});
    }
    find_slivers(mesh, topology);
    return topology;
}

}  // namespace earshot::geometry
