// SPDX-License-Identifier: MIT
#include "earshot/geometry/planar_regions.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/internal/border_loops.h"
#include "earshot/geometry/internal/projection.h"
#include "earshot/geometry/internal/surface_samples.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/topology.h"
#include "earshot/geometry/triangulate.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace earshot::geometry {
namespace {

constexpr VertexId kNoVertex = 0xffffffffU;

/// The lines between facets. A vertex at which just two border edges meet may be left out.
class BorderLines {
public:
    BorderLines(const MeshView& mesh,
                std::span<const FacetId> of_triangle,
                const EdgeTable& edges,
                std::span<const HalfEdgeId> twins)
        : positions_(mesh.positions),
          degrees_(mesh.positions.size(), 0),
          neighbours_(mesh.positions.size(), {kNoVertex, kNoVertex}) {
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const HalfEdgeId h = edges.uses(e).front();
            const bool is_inside =
                twins[h] != kNoHalfEdge &&
                of_triangle[triangle_of(h)] == of_triangle[triangle_of(twins[h])];
            if (!is_inside) {
                add_neighbour(start_of(mesh.triangles, h), end_of(mesh.triangles, h));
                add_neighbour(end_of(mesh.triangles, h), start_of(mesh.triangles, h));
            }
        }
    }

    /// Per vertex whether it is on a border line and not needed: within `tolerance` of the straight
    /// line between those that are (Douglas and Peucker 1973). Vertices that must stay are.
    std::vector<bool> straight_vertices(const std::vector<bool>& must_stay,
                                        double tolerance) const {
        std::vector<bool> is_straight(degrees_.size(), false);
        std::vector<bool> is_visited(degrees_.size(), false);
        const auto is_inner = [&](VertexId v) { return degrees_[v] == 2 && !must_stay[v]; };
        for (VertexId v = 0; v < degrees_.size(); ++v) {
            if (is_visited[v] || !is_inner(v)) {
                continue;
            }
            std::vector<VertexId> chain = walk(v, neighbours_[v][0], is_inner);
            if (chain.back() == v) {
                mark_ring(std::move(chain), tolerance, is_visited, is_straight);
                continue;
            }
            std::reverse(chain.begin(), chain.end());
            const std::vector<VertexId> rest = walk(v, neighbours_[v][1], is_inner);
            chain.insert(chain.end(), rest.begin() + 1, rest.end());
            mark(chain, tolerance, is_visited, is_straight);
        }
        return is_straight;
    }

private:
    void add_neighbour(VertexId vertex, VertexId other) {
        if (degrees_[vertex] < 2) {
            neighbours_[vertex][degrees_[vertex]] = other;
        }
        ++degrees_[vertex];
    }

    /// From a vertex on to the first that is no inner one, or round to itself.
    template <typename IsInner>
    std::vector<VertexId> walk(VertexId from, VertexId to, const IsInner& is_inner) const {
        std::vector<VertexId> path{from, to};
        while (path.back() != from && is_inner(path.back())) {
            const auto& [a, b] = neighbours_[path.back()];
            path.push_back(a == path[path.size() - 2] ? b : a);
        }
        return path;
    }

    /// Of a ring, whose first vertex stands at the end again: its smallest vertex and the one
    /// farthest from it stay, so that the result does not depend on where it began.
    void mark_ring(std::vector<VertexId> ring,
                   double tolerance,
                   std::vector<bool>& is_visited,
                   std::vector<bool>& is_straight) const {
        ring.pop_back();
        const auto smallest = std::min_element(ring.begin(), ring.end(), [&](auto a, auto b) {
            return lexicographic_less(positions_[a], positions_[b]);
        });
        std::rotate(ring.begin(), smallest, ring.end());
        const Vec3 start = positions_[ring.front()];
        std::size_t farthest = 0;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const auto squared = [&](std::size_t k) {
                const Vec3 rest = positions_[ring[k]] - start;
                return glm::dot(rest, rest);
            };
            farthest = squared(i) > squared(farthest) ? i : farthest;
        }
        ring.push_back(ring.front());
        const auto middle = ring.begin() + static_cast<std::ptrdiff_t>(farthest);
        mark({ring.begin(), middle + 1}, tolerance, is_visited, is_straight);
        mark({middle, ring.end()}, tolerance, is_visited, is_straight);
    }

    /// Of a chain, whose ends stay.
    void mark(const std::vector<VertexId>& chain,
              double tolerance,
              std::vector<bool>& is_visited,
              std::vector<bool>& is_straight) const {
        for (std::size_t i = 0; i < chain.size(); ++i) {
            const bool is_end = i == 0 || i + 1 == chain.size();
            is_visited[chain[i]] = is_visited[chain[i]] || degrees_[chain[i]] == 2;
            is_straight[chain[i]] = is_straight[chain[i]] || !is_end;
        }
        std::vector<std::pair<std::size_t, std::size_t>> stack{{0, chain.size() - 1}};
        while (!stack.empty()) {
            const auto [begin, end] = stack.back();
            stack.pop_back();
            std::size_t farthest = begin;
            double squared = tolerance * tolerance;
            const Corners line{
                positions_[chain[begin]], positions_[chain[end]], positions_[chain[end]]};
            for (std::size_t i = begin + 1; i < end; ++i) {
                const double other = squared_distance(positions_[chain[i]], line);
                if (other > squared) {
                    squared = other;
                    farthest = i;
                }
            }
            if (farthest != begin) {
                is_straight[chain[farthest]] = false;
                stack.emplace_back(begin, farthest);
                stack.emplace_back(farthest, end);
            }
        }
    }

    std::span<const Vec3> positions_;
    std::vector<std::uint32_t> degrees_;               // border edges per vertex
    std::vector<std::array<VertexId, 2>> neighbours_;  // along border edges, where there are two
};

/// A facet in two dimensions.
struct FlatFacet {
    std::vector<VertexId> vertices;  // per point
    std::vector<glm::dvec2> points;  // counter-clockwise seen from the front
    std::vector<IndexLoop> loops;    // the outline first
};

double doubled_area(std::span<const glm::dvec2> points, const IndexLoop& loop) {
    double sum = 0.0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        const glm::dvec2 a = points[loop[i]] - points[loop[0]];
        const glm::dvec2 b = points[loop[i + 1]] - points[loop[0]];
        sum += a.x * b.y - a.y * b.x;
    }
    return sum;
}

/// False unless the loops are one outline and holes in it, apart from each other.
bool order_loops(FlatFacet& flat) {
    std::vector<VertexId> sorted = flat.vertices;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
        return false;
    }
    std::size_t outlines = 0;
    for (std::size_t i = 0; i < flat.loops.size(); ++i) {
        if (flat.loops[i].size() < 3) {
            return false;
        }
        if (doubled_area(flat.points, flat.loops[i]) > 0.0) {
            std::swap(flat.loops[0], flat.loops[i]);
            ++outlines;
        }
    }
    return outlines == 1;
}

/// One mesh whose facets are triangulated anew.
class PlanarMerge {
public:
    PlanarMerge(const MeshView& mesh, std::span<const std::uint32_t> labels, Executor& executor)
        : mesh_(mesh) {
        std::vector<VertexId> weld(mesh.positions.size());
        std::iota(weld.begin(), weld.end(), VertexId{0});
        facets_ = find_facets(mesh, weld, labels, executor);
        const EdgeTable edges(mesh.triangles, mesh.positions.size());
        const std::vector<HalfEdgeId> twins = twins_of(edges, mesh.triangles);
        lines_.emplace(mesh, facets_.of_triangle, edges, twins);
        BorderWalk walk(mesh.triangles, twins, facets_.of_triangle, mesh.positions.size());
        loops_.resize(facets_.facets.size());
        must_stay_.assign(mesh.positions.size(), false);
        stays_.assign(facets_.facets.size(), false);
        for (FacetId f = 0; f < loops_.size(); ++f) {
            loops_[f] = walk.loops(facets_.facets[f].triangles);
            if (facets_.facets[f].triangles.size() == 1) {
                keep(f);
            }
        }
    }

    SimplifiedMesh run() {
        // A facet that stays keeps the vertices of its borders, which its neighbours then need.
        std::vector<std::vector<Triangle>> filled(loops_.size());
        for (bool has_changed = true; has_changed;) {
            has_changed = false;
            is_straight_ = lines_->straight_vertices(must_stay_, facets_.tolerance);
            for (FacetId f = 0; f < loops_.size(); ++f) {
                filled[f] = stays_[f] ? std::vector<Triangle>{} : fill(f);
                if (!stays_[f] && filled[f].empty()) {
                    keep(f);
                    has_changed = true;
                }
            }
        }
        return collect(filled);
    }

private:
    void keep(FacetId f) {
        stays_[f] = true;
        for (const TriangleId id : facets_.facets[f].triangles) {
            for (const VertexId vertex : mesh_.triangles[id]) {
                must_stay_[vertex] = true;
            }
        }
    }

    FlatFacet flattened(FacetId f) const {
        const Vec3& normal = facets_.facets[f].plane.normal;
        const Vec3 size = glm::abs(normal);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        FlatFacet flat;
        for (const std::vector<VertexId>& loop : loops_[f]) {
            IndexLoop& indices = flat.loops.emplace_back();
            for (const VertexId vertex : loop) {
                if (!is_straight_[vertex]) {
                    const glm::dvec2 p = project_along(mesh_.positions[vertex], axis);
                    indices.push_back(flat.points.size());
                    flat.points.push_back(normal[axis] < 0.0 ? glm::dvec2(p.y, p.x) : p);
                    flat.vertices.push_back(vertex);
                }
            }
        }
        return flat;
    }

    /// The triangles of a facet, none where it should stay.
    std::vector<Triangle> fill(FacetId f) const {
        FlatFacet flat = flattened(f);
        if (flat.points.size() > kMaxFacetCorners || flat.loops.empty() || !order_loops(flat)) {
            return {};
        }
        double area = 0.0;
        for (const IndexLoop& loop : flat.loops) {
            area += doubled_area(flat.points, loop);
        }
        std::vector<Triangle> triangles;
        double filled_area = 0.0;
        for (const auto& [a, b, c] :
             triangulate(flat.points, flat.loops, EarOrder::shortest_diagonal)) {
            if (orient2d(flat.points[a], flat.points[b], flat.points[c]) <= 0) {
                return {};
            }
            filled_area += doubled_area(flat.points, {a, b, c});
            triangles.push_back({flat.vertices[a], flat.vertices[b], flat.vertices[c]});
        }
        // Positive areas that add up to that of the polygon: they cover it once. The sums round by
        // far less than a triangle that matters.
        constexpr double kMaxDifference = 1e-9;
        return std::abs(filled_area - area) <= kMaxDifference * area &&
                       std::abs(projected_area(f) - area) <= 1e-6 * area + border_area(flat)
                   ? triangles
                   : std::vector<Triangle>{};
    }

    /// Twice the area of the facet as it is, in its projection.
    double projected_area(FacetId f) const {
        const Vec3& normal = facets_.facets[f].plane.normal;
        const Vec3 size = glm::abs(normal);
        double sum = 0.0;
        for (const TriangleId id : facets_.facets[f].triangles) {
            const auto [a, b, c] = corners(mesh_, id);
            sum += glm::dot(glm::cross(b - a, c - a), normal);
        }
        return sum * std::max({size.x, size.y, size.z});
    }

    /// What leaving out vertices within the tolerance of straight borders may change of it.
    double border_area(const FlatFacet& flat) const {
        double length = 0.0;
        for (const IndexLoop& loop : flat.loops) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const glm::dvec2 along =
                    flat.points[loop[(i + 1) % loop.size()]] - flat.points[loop[i]];
                length += std::sqrt(along.x * along.x + along.y * along.y);
            }
        }
        return 4.0 * facets_.tolerance * length;
    }

    SimplifiedMesh collect(const std::vector<std::vector<Triangle>>& filled) const {
        SimplifiedMesh result;
        std::vector<VertexId> number(mesh_.positions.size(), kNoVertex);
        const auto add = [&](Triangle triangle, TriangleId origin) {
            for (VertexId& vertex : triangle) {
                if (number[vertex] == kNoVertex) {
                    number[vertex] = static_cast<VertexId>(result.mesh.positions.size());
                    result.mesh.positions.push_back(mesh_.positions[vertex]);
                }
                vertex = number[vertex];
            }
            result.mesh.triangles.push_back(triangle);
            result.origins.push_back(origin);
        };
        for (FacetId f = 0; f < filled.size(); ++f) {
            const std::vector<TriangleId>& old = facets_.facets[f].triangles;
            if (stays_[f]) {
                for (const TriangleId id : old) {
                    add(mesh_.triangles[id], id);
                }
            }
            for (const Triangle& triangle : filled[f]) {
                add(triangle, old.front());
            }
        }
        return result;
    }

    MeshView mesh_;
    Facets facets_;
    std::optional<BorderLines> lines_;
    std::vector<std::vector<std::vector<VertexId>>> loops_;  // per facet
    std::vector<bool> must_stay_;                            // per vertex
    std::vector<bool> stays_;                                // per facet
    std::vector<bool> is_straight_;                          // per vertex
};

}  // namespace

SimplifiedMesh merge_planar_regions(const MeshView& mesh,
                                    std::span<const std::uint32_t> labels,
                                    Executor& executor) {
    EARSHOT_ASSERT(labels.size() == mesh.triangles.size());
    if (mesh.triangles.empty()) {
        return {};
    }
    return PlanarMerge(mesh, labels, executor).run();
}

}  // namespace earshot::geometry
