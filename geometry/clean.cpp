// SPDX-License-Identifier: MIT
#include "earshot/geometry/clean.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/internal/point_tree.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/geometry/topology.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

namespace earshot::geometry {
namespace {

struct IndexedPosition {
    Vec3 position{0.0};
    VertexId vertex = 0;
};

bool is_before(const IndexedPosition& a, const IndexedPosition& b) noexcept {
    return a.position == b.position ? a.vertex < b.vertex
                                    : lexicographic_less(a.position, b.position);
}

std::vector<VertexId> weld_equal_positions(std::span<const Vec3> positions) {
    std::vector<IndexedPosition> sorted(positions.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        sorted[i] = {positions[i], static_cast<VertexId>(i)};
    }
    std::sort(sorted.begin(), sorted.end(), is_before);
    std::vector<VertexId> weld(positions.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const bool repeats = i > 0 && sorted[i].position == sorted[i - 1].position;
        weld[sorted[i].vertex] = repeats ? weld[sorted[i - 1].vertex] : sorted[i].vertex;
    }
    return weld;
}

/// Exactly: the components of the normal are the areas of the three projections.
bool has_zero_area(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 &&
           orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
           orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

bool is_degenerate(const Triangle& welded, std::span<const Vec3> positions) noexcept {
    const auto [a, b, c] = welded;
    return a == b || b == c || c == a || has_zero_area(positions[a], positions[b], positions[c]);
}

/// The triangles of `candidates` (ascending) that repeat no earlier one with the same vertices.
std::vector<TriangleId> without_duplicates(std::span<const TriangleId> candidates,
                                           std::span<const Triangle> welded,
                                           std::vector<DuplicateTriangle>& duplicates) {
    std::vector<std::pair<Triangle, TriangleId>> keyed;
    keyed.reserve(candidates.size());
    for (const TriangleId id : candidates) {
        Triangle key = welded[id];
        std::sort(key.begin(), key.end());
        keyed.emplace_back(key, id);
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<TriangleId> kept;
    kept.reserve(keyed.size());
    for (std::size_t i = 0; i < keyed.size(); ++i) {
        if (i == 0 || keyed[i].first != keyed[i - 1].first) {
            kept.push_back(keyed[i].second);
        } else {
            duplicates.push_back({keyed[i].second, kept.back()});
        }
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

/// A triangle whose smallest height is at least so many tolerances has corners that a shift of one
/// tolerance each cannot exchange, nor turn it over.
constexpr double kMinHeightInTolerances = 8.0;

bool is_higher_than(const std::array<Vec3, 3>& p, double height) noexcept {
    const Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const Vec3 a = p[1] - p[0];
    const Vec3 b = p[2] - p[1];
    const Vec3 c = p[0] - p[2];
    const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
    return glm::dot(normal, normal) > height * height * longest;
}

/// Whether the corners of a lie within the tolerance of those of b, in some order.
bool corners_agree(const std::array<Vec3, 3>& a,
                   const std::array<Vec3, 3>& b,
                   double tolerance) noexcept {
    const auto close = [&](const Vec3& p, const Vec3& q) {
        return glm::dot(p - q, p - q) <= tolerance * tolerance;
    };
    for (std::size_t first = 0; first < 3; ++first) {
        const std::size_t second = (first + 1) % 3;
        const std::size_t third = (first + 2) % 3;
        if (close(a[0], b[first]) && ((close(a[1], b[second]) && close(a[2], b[third])) ||
                                      (close(a[1], b[third]) && close(a[2], b[second])))) {
            return true;
        }
    }
    return false;
}

/// Pairs (later, earlier) of triangles whose corners agree within the tolerance, ascending. Then
/// the means of their corners lie within it as well, and so do, but for a factor, the means'
/// positions along any direction. The direction has no rational relation between its coordinates,
/// so that few triangles of a model lie side by side along it.
std::vector<std::pair<TriangleId, TriangleId>> find_near_duplicates(
    const MeshView& mesh, std::span<const TriangleId> candidates, double tolerance) {
    constexpr Vec3 kDirection = {1.0, 0.7548776662466927, 0.5698402909980532};
    constexpr double kWindow = 1.5;  // more than the length of the direction
    const auto corners_of = [&](TriangleId id) {
        const auto [a, b, c] = mesh.triangles[id];
        return std::array<Vec3, 3>{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
    };
    std::vector<std::pair<double, TriangleId>> along;
    for (const TriangleId id : candidates) {
        const auto p = corners_of(id);
        if (is_higher_than(p, kMinHeightInTolerances * tolerance)) {
            along.emplace_back(glm::dot(kDirection, p[0] + p[1] + p[2]) / 3.0, id);
        }
    }
    std::sort(along.begin(), along.end());
    std::vector<std::pair<TriangleId, TriangleId>> pairs;
    for (std::size_t i = 0; i < along.size(); ++i) {
        const auto& [position, id] = along[i];
        for (std::size_t k = i + 1;
             k < along.size() && along[k].first - position <= kWindow * tolerance;
             ++k) {
            const TriangleId other = along[k].second;
            if (corners_agree(corners_of(id), corners_of(other), tolerance)) {
                pairs.emplace_back(std::max(id, other), std::min(id, other));
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

/// Removes from `kept` (ascending) what repeats an earlier triangle within the tolerance.
void remove_near_duplicates(const MeshView& mesh,
                            double tolerance,
                            std::vector<TriangleId>& kept,
                            std::vector<DuplicateTriangle>& duplicates) {
    const auto pairs = find_near_duplicates(mesh, kept, tolerance);
    if (pairs.empty()) {
        return;
    }
    std::vector<TriangleId> repeated(mesh.triangles.size());  // itself, or the one that it repeats
    std::iota(repeated.begin(), repeated.end(), TriangleId{0});
    for (const auto& [later, earlier] : pairs) {
        if (repeated[later] == later && repeated[earlier] == earlier) {
            repeated[later] = earlier;
        }
    }
    for (DuplicateTriangle& exact : duplicates) {
        exact.kept = repeated[exact.kept];
    }
    for (const TriangleId id : kept) {
        if (repeated[id] != id) {
            duplicates.push_back({id, repeated[id]});
        }
    }
    std::erase_if(kept, [&](TriangleId id) { return repeated[id] != id; });
}

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

std::size_t count_t_junctions(std::span<const Edge> open_edges,
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
    std::size_t count = 0;
    for (const auto& [a, b] : open_edges) {
        const Segment edge{positions[a], positions[b]};
        tree.near_segment(edge, tolerance, [&](const PointTree::Point& point) {
            if (!is_junction[point.vertex] && lies_inside(point.position, edge, tolerance)) {
                is_junction[point.vertex] = true;
                ++count;
            }
        });
    }
    return count;
}

void count_edges(std::span<const Triangle> triangles,
                 std::span<const Vec3> positions,
                 CleanReport& report) {
    const EdgeTable edges(triangles, positions.size());
    std::vector<Edge> open;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const std::span<const HalfEdgeId> uses = edges.uses(e);
        if (uses.size() == 1) {
            open.emplace_back(start_of(triangles, uses[0]), end_of(triangles, uses[0]));
        }
        report.non_manifold_edges += uses.size() > 2 ? 1 : 0;
    }
    report.open_edges = open.size();
    report.holes = count_components(open, positions.size());
    const double tolerance = coplanar_tolerance({positions, triangles});
    report.t_junctions = count_t_junctions(open, positions, tolerance);
}

}  // namespace

CleanMesh clean(const MeshView& mesh) {
    CleanMesh result;
    CleanReport& report = result.report;
    report.triangles_read = mesh.triangles.size();
    report.vertices_read = mesh.positions.size();

    result.weld = weld_equal_positions(mesh.positions);
    for (std::size_t v = 0; v < result.weld.size(); ++v) {
        report.vertices_welded += result.weld[v] != v ? 1 : 0;
    }

    std::vector<Triangle> welded(mesh.triangles.size());
    std::vector<TriangleId> with_area;
    with_area.reserve(welded.size());
    for (std::size_t t = 0; t < welded.size(); ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        welded[t] = {result.weld[a], result.weld[b], result.weld[c]};
        if (!is_degenerate(welded[t], mesh.positions)) {
            with_area.push_back(static_cast<TriangleId>(t));
        }
    }
    report.degenerate_triangles = welded.size() - with_area.size();
    result.kept = without_duplicates(with_area, welded, result.duplicates);
    remove_near_duplicates(mesh, coplanar_tolerance(mesh), result.kept, result.duplicates);
    std::sort(result.duplicates.begin(), result.duplicates.end(), [](const auto& a, const auto& b) {
        return a.duplicate < b.duplicate;
    });
    report.duplicate_triangles = with_area.size() - result.kept.size();

    // In place: kept is ascending, so nothing is overwritten before it is read.
    for (std::size_t i = 0; i < result.kept.size(); ++i) {
        welded[i] = welded[result.kept[i]];
    }
    welded.resize(result.kept.size());
    count_edges(welded, mesh.positions, report);
    return result;
}

}  // namespace earshot::geometry
