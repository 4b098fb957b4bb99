// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/manifold_fans.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/vector.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace earshot::geometry {
namespace {

/// Per half-edge its neighbour across the edge, or kNoHalfEdge. In a pair of the same direction one
/// of the triangles has the other winding.
using Neighbours = std::vector<HalfEdgeId>;

/// The unit vector from the edge of `h` into its triangle, in its plane.
Vec3 inward(std::span<const Triangle> triangles, std::span<const Vec3> positions, HalfEdgeId h) {
    const HalfEdgeId next = next_in_triangle(h);
    // From the edge's lower vertex, so that half-edges of both directions round alike.
    const VertexId a = std::min(start_of(triangles, h), end_of(triangles, h));
    const VertexId b = std::max(start_of(triangles, h), end_of(triangles, h));
    const Vec3 along = direction_between(positions[a], positions[b]);
    const Vec3 to_apex = positions[end_of(triangles, next)] - positions[a];
    return normalized_or_zero(to_apex - glm::dot(to_apex, along) * along);
}

/// Of more than two triangles: pairs of opposite direction, the flattest first (Gueziec et al.
/// 2001: stitching of the fans that cutting has made).
void pair_crowded_edge(std::span<const Triangle> triangles,
                       std::span<const Vec3> positions,
                       std::span<const HalfEdgeId> uses,
                       Neighbours& neighbours) {
    std::vector<std::tuple<double, HalfEdgeId, HalfEdgeId>> pairs;
    std::vector<Vec3> directions;
    for (const HalfEdgeId h : uses) {
        directions.push_back(inward(triangles, positions, h));
    }
    for (std::size_t i = 0; i < uses.size(); ++i) {
        for (std::size_t k = i + 1; k < uses.size(); ++k) {
            if (start_of(triangles, uses[i]) != start_of(triangles, uses[k])) {
                pairs.emplace_back(glm::dot(directions[i], directions[k]), uses[i], uses[k]);
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [cosine, a, b] : pairs) {
        if (neighbours[a] == kNoHalfEdge && neighbours[b] == kNoHalfEdge) {
            neighbours[a] = b;
            neighbours[b] = a;
        }
    }
}

Neighbours find_neighbours(const EdgeTable& edges,
                           std::span<const Triangle> triangles,
                           std::span<const Vec3> positions) {
    Neighbours neighbours(3 * triangles.size(), kNoHalfEdge);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const std::span<const HalfEdgeId> uses = edges.uses(e);
        if (uses.size() == 2) {
            neighbours[uses[0]] = uses[1];
            neighbours[uses[1]] = uses[0];
        } else if (uses.size() > 2) {
            pair_crowded_edge(triangles, positions, uses, neighbours);
        }
    }
    return neighbours;
}

/// Follows a patch from its lowest triangle and tells each triangle whether it has the winding of
/// the first one.
class Orientation {
public:
    Orientation(std::span<const Triangle> triangles,
                std::span<const Vec3> positions,
                Neighbours& neighbours)
        : triangles_(triangles), positions_(positions), neighbours_(neighbours) {
        patch.assign(triangles.size(), kNone);
        is_flipped.assign(triangles.size(), false);
        for (TriangleId t = 0; t < triangles.size(); ++t) {
            if (patch[t] == kNone) {
                follow(t);
            }
        }
    }

    std::vector<std::uint32_t> patch;
    std::vector<bool> is_flipped;
    std::vector<bool> is_orientable;  // per patch

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;

    double area(TriangleId t) const {
        const auto [a, b, c] = corners(positions_, triangles_[t]);
        return glm::length(glm::cross(b - a, c - a));
    }

    void follow(TriangleId first) {
        const auto id = static_cast<std::uint32_t>(is_orientable.size());
        is_orientable.push_back(true);
        patch[first] = id;
        std::vector<TriangleId> members{first};
        double flipped_area = 0.0;
        double area_of_all = 0.0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const TriangleId t = members[i];
            area_of_all += area(t);
            flipped_area += is_flipped[t] ? area(t) : 0.0;
            for (HalfEdgeId h = 3 * t; h < 3 * t + 3; ++h) {
                visit(h, id, members);
            }
        }
        if (2.0 * flipped_area > area_of_all) {
            for (const TriangleId t : members) {
                is_flipped[t] = !is_flipped[t];
            }
        }
    }

    void visit(HalfEdgeId h, std::uint32_t id, std::vector<TriangleId>& members) {
        const HalfEdgeId twin = neighbours_[h];
        if (twin == kNoHalfEdge) {
            return;
        }
        const TriangleId other = triangle_of(twin);
        const bool same_direction = start_of(triangles_, h) == start_of(triangles_, twin);
        const bool flip = is_flipped[triangle_of(h)] != same_direction;
        if (patch[other] == kNone) {
            patch[other] = id;
            is_flipped[other] = flip;
            members.push_back(other);
        } else if (is_flipped[other] != flip) {
            is_orientable[id] = false;
            neighbours_[h] = neighbours_[twin] = kNoHalfEdge;
        }
    }

    std::span<const Triangle> triangles_;
    std::span<const Vec3> positions_;
    Neighbours& neighbours_;
};

/// One number per fan: corners of neighbouring triangles at one vertex are one.
std::size_t number_fans(std::span<const Triangle> triangles,
                        const Neighbours& neighbours,
                        std::vector<Triangle>& fans) {
    DisjointSets sets(3 * triangles.size());  // of corners, which have the numbers of half-edges
    for (HalfEdgeId h = 0; h < neighbours.size(); ++h) {
        const HalfEdgeId twin = neighbours[h];
        if (twin == kNoHalfEdge || twin < h) {
            continue;
        }
        const bool same = start_of(triangles, h) == start_of(triangles, twin);
        sets.unite(h, same ? twin : next_in_triangle(twin));
        sets.unite(next_in_triangle(h), same ? next_in_triangle(twin) : twin);
    }
    std::vector<VertexId> number(3 * triangles.size());
    VertexId count = 0;
    fans.resize(triangles.size());
    for (HalfEdgeId corner = 0; corner < number.size(); ++corner) {
        const std::uint32_t root = sets.find(corner);
        number[corner] = root == corner ? count++ : number[root];  // the root is the lowest
        fans[triangle_of(corner)][corner % 3] = number[corner];
    }
    return count;
}

/// Splits edges in which fans meet again: a fan may go around its vertex so that it passes the same
/// crowded edge twice. True if there were any.
bool split_pinched_edges(std::span<const Triangle> fans,
                         std::size_t fan_count,
                         Neighbours& neighbours) {
    bool found = false;
    const EdgeTable edges(fans, fan_count);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const std::span<const HalfEdgeId> uses = edges.uses(e);
        for (std::size_t i = 0; uses.size() > 2 && i < uses.size(); ++i) {
            const HalfEdgeId twin = neighbours[uses[i]];
            if (twin != kNoHalfEdge) {
                neighbours[uses[i]] = neighbours[twin] = kNoHalfEdge;
                found = true;
            }
        }
    }
    return found;
}

}  // namespace

ManifoldFans split_fans(std::span<const Triangle> triangles, std::span<const Vec3> positions) {
    const EdgeTable edges(triangles, positions.size());
    Neighbours neighbours = find_neighbours(edges, triangles, positions);
    Orientation orientation(triangles, positions, neighbours);
    ManifoldFans result;
    do {
        result.vertex_count = number_fans(triangles, neighbours, result.triangles);
    } while (split_pinched_edges(result.triangles, result.vertex_count, neighbours));
    result.uses_of_border.assign(3 * triangles.size(), 0);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        for (const HalfEdgeId h : edges.uses(e)) {
            if (neighbours[h] == kNoHalfEdge) {
                // Of the half-edge in the turned triangle: swapping corners 1 and 2 swaps the edges
                // 0 and 2.
                const TriangleId t = triangle_of(h);
                result.uses_of_border[orientation.is_flipped[t] ? 3 * t + 2 - h % 3 : h] =
                    static_cast<std::uint32_t>(edges.uses(e).size());
            }
        }
    }
    for (TriangleId t = 0; t < triangles.size(); ++t) {
        if (orientation.is_flipped[t]) {
            std::swap(result.triangles[t][1], result.triangles[t][2]);
        }
    }
    result.is_flipped = std::move(orientation.is_flipped);
    result.patch = std::move(orientation.patch);
    result.is_patch_orientable = std::move(orientation.is_orientable);
    return result;
}

}  // namespace earshot::geometry
