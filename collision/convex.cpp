// SPDX-License-Identifier: MIT
#include "earshot/collision/convex.h"

#include "earshot/collision/weld.h"
#include "earshot/geometry/disjoint_sets.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

namespace {

/// What a vertex may lie outside of a face, of the size of the component: far above what storing
/// positions in single precision moves them (2^-24), far below what modellers call concave.
constexpr double kConvexTolerance = 1e-6;
/// Of the cube of the size: less is a surface that encloses nothing.
constexpr double kMinVolume = 1e-12;
/// Triangles whose height is a smaller fraction of their longest edge have no reliable normal.
constexpr double kMinHeight = 1e-9;
/// Face normals whose cross product is shorter count as parallel.
constexpr double kParallel = 1e-9;

/// A directed edge of a triangle.
struct HalfEdge {
    VertexId from, to;
    std::uint32_t triangle;

    std::pair<VertexId, VertexId> edge() const noexcept { return std::minmax(from, to); }
};

/// The half-edges in pairs of opposite ones; empty if any edge is not in two triangles, once in
/// each direction.
std::vector<HalfEdge> opposite_pairs(std::span<const Triangle> triangles) {
    std::vector<HalfEdge> edges;
    edges.reserve(3 * triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        for (unsigned k = 0; k < 3; ++k) {
            edges.push_back({triangles[i][k], triangles[i][(k + 1) % 3], i});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
        const auto edge_a = a.edge(), edge_b = b.edge();
        return std::tie(edge_a, a.from, a.triangle) < std::tie(edge_b, b.from, b.triangle);
    });
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        const bool is_pair = i + 1 < edges.size() && edges[i].edge() == edges[i + 1].edge() &&
                             edges[i].from != edges[i + 1].from &&
                             (i + 2 == edges.size() || edges[i + 2].edge() != edges[i].edge());
        if (!is_pair) {
            return {};
        }
    }
    return edges;
}

/// For each triangle the first of its component.
std::vector<std::uint32_t> components_of(std::size_t triangles, std::span<const HalfEdge> edges) {
    geometry::DisjointSets sets(triangles);
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        sets.unite(edges[i].triangle, edges[i + 1].triangle);
    }
    std::vector<std::uint32_t> components(triangles);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        components[i] = sets.find(i);
    }
    return components;
}

/// Makes a part of the triangles of one component.
class PartBuilder {
public:
    PartBuilder(std::span<const Vec3> positions,
                std::span<const Triangle> triangles,
                std::span<const std::uint32_t> members)
        : positions_(positions), triangles_(triangles), members_(members) {}

    std::optional<ConvexPart> build(std::span<const HalfEdge> edges) {
        collect_vertices();
        if (!find_normals() || !is_convex()) {
            return std::nullopt;
        }
        add_edges(edges);
        return std::move(part_);
    }

private:
    static constexpr std::uint32_t kNoNormal = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t index_of(VertexId vertex) const {
        return static_cast<std::uint32_t>(
            std::lower_bound(vertices_.begin(), vertices_.end(), vertex) - vertices_.begin());
    }

    std::uint32_t normal_of(std::uint32_t triangle) const {
        const auto member = std::lower_bound(members_.begin(), members_.end(), triangle);
        return normal_of_member_[static_cast<std::size_t>(member - members_.begin())];
    }

    void collect_vertices() {
        for (const std::uint32_t i : members_) {
            vertices_.insert(vertices_.end(), triangles_[i].begin(), triangles_[i].end());
        }
        std::sort(vertices_.begin(), vertices_.end());
        vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
        for (const VertexId vertex : vertices_) {
            part_.vertices.push_back(positions_[vertex]);
        }
        Vec3 lower = part_.vertices[0], upper = part_.vertices[0];
        for (const Vec3& vertex : part_.vertices) {
            lower = glm::min(lower, vertex);
            upper = glm::max(upper, vertex);
        }
        size_ = glm::length(upper - lower);
        middle_ = 0.5 * (lower + upper);
    }

    /// Outward normals of the triangles that have an area; false if the volume is 0.
    bool find_normals() {
        double volume = 0.0;
        for (const std::uint32_t i : members_) {
            const auto& [a, b, c] = triangles_[i];
            volume += glm::dot(positions_[a] - middle_,
                               glm::cross(positions_[b] - middle_, positions_[c] - middle_));
        }
        if (!(std::abs(volume) > kMinVolume * size_ * size_ * size_)) {
            return false;
        }
        const double outward = volume > 0.0 ? 1.0 : -1.0;
        for (const std::uint32_t i : members_) {
            const auto& [a, b, c] = triangles_[i];
            const Vec3 ab = positions_[b] - positions_[a];
            const Vec3 ac = positions_[c] - positions_[a];
            const Vec3 bc = positions_[c] - positions_[b];
            const Vec3 normal = outward * glm::cross(ab, ac);
            const double length = glm::length(normal);
            const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
            const bool has_normal = length > kMinHeight * longest;
            normal_of_member_.push_back(
                has_normal ? static_cast<std::uint32_t>(part_.normals.size()) : kNoNormal);
            if (has_normal) {
                part_.normals.push_back(normal / length);
                offsets_.push_back(glm::dot(part_.normals.back(), positions_[a] - middle_));
            }
        }
        return !part_.normals.empty();
    }

    bool is_convex() const {
        for (std::size_t i = 0; i < part_.normals.size(); ++i) {
            for (const Vec3& vertex : part_.vertices) {
                if (glm::dot(part_.normals[i], vertex - middle_) - offsets_[i] >
                    kConvexTolerance * size_) {
                    return false;
                }
            }
        }
        return true;
    }

    /// Edges between triangles that are not coplanar. Beside a triangle without a normal the arc of
    /// an edge is the normal of its other triangle.
    void add_edges(std::span<const HalfEdge> edges) {
        for (std::size_t i = 0; i < edges.size(); i += 2) {
            const std::uint32_t n0 = normal_of(edges[i].triangle);
            const std::uint32_t n1 = normal_of(edges[i + 1].triangle);
            const bool is_flat =
                n0 != kNoNormal && n1 != kNoNormal &&
                glm::length(glm::cross(part_.normals[n0], part_.normals[n1])) < kParallel;
            if (!is_flat) {
                const std::uint32_t a = n0 != kNoNormal ? n0 : n1;
                const std::uint32_t b = n1 != kNoNormal ? n1 : n0;
                if (a != kNoNormal) {
                    part_.edges.push_back(
                        {{index_of(edges[i].from), index_of(edges[i].to)}, {a, b}});
                }
            }
        }
    }

    std::span<const Vec3> positions_;
    std::span<const Triangle> triangles_;
    std::span<const std::uint32_t> members_;  // ascending
    std::vector<VertexId> vertices_;          // ascending
    std::vector<std::uint32_t> normal_of_member_;
    std::vector<double> offsets_;  // of the planes from the middle
    ConvexPart part_;
    double size_ = 0.0;
    Vec3 middle_{0.0};
};

/// A part in the world, relative to an origin near it.
struct PlacedPart {
    std::vector<Vec3> vertices, normals;
    std::span<const ConvexPart::Edge> edges;

    PlacedPart(const ConvexPart& part, const Pose& pose, const Vec3& origin) : edges(part.edges) {
        for (const Vec3& vertex : part.vertices) {
            vertices.push_back(pose.apply(vertex) - origin);
        }
        for (const Vec3& normal : part.normals) {
            normals.push_back(pose.rotation * normal);
        }
    }

    double support(const Vec3& direction) const noexcept {
        double largest = -std::numeric_limits<double>::infinity();
        for (const Vec3& vertex : vertices) {
            largest = std::max(largest, glm::dot(direction, vertex));
        }
        return largest;
    }
    Vec3 along(const ConvexPart::Edge& edge) const noexcept {
        return vertices[edge.vertices[1]] - vertices[edge.vertices[0]];
    }
};

/// Whether the arcs of two edges may intersect on the Gauss map, that of b on the map of -b: if
/// not, their cross product is no face normal of the Minkowski difference.
bool arcs_may_intersect(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) noexcept {
    constexpr double kRounding = 1e-14;
    const Vec3 across_a = glm::cross(a1, a0);
    const Vec3 across_b = glm::cross(b1, b0);
    const double b0_side = glm::dot(b0, across_a);
    const double b1_side = glm::dot(b1, across_a);
    const double a0_side = glm::dot(a0, across_b);
    const double a1_side = glm::dot(a1, across_b);
    // Each arc has its ends on both sides of the other's great circle, and they are on one
    // hemisphere (Gregorius 2013).
    return b0_side * b1_side <= kRounding && a0_side * a1_side <= kRounding &&
           b0_side * a1_side >= -kRounding;
}

/// Finds the direction of the smallest overlap of extents.
class DepthSearch {
public:
    DepthSearch(const PlacedPart& a, const PlacedPart& b) : a_(a), b_(b) {}

    /// `direction`: unit, along which b moves away from a. Returns whether no direction so far
    /// separates the solids.
    bool add(const Vec3& direction) {
        const double overlap = a_.support(direction) + b_.support(-direction);
        if (overlap < depth) {
            depth = overlap;
            best = direction;
        }
        return depth >= 0.0;
    }

    /// Whether the solids are not disjoint.
    bool run() {
        for (const Vec3& normal : a_.normals) {
            if (!add(normal)) {
                return false;
            }
        }
        for (const Vec3& normal : b_.normals) {
            if (!add(-normal)) {
                return false;
            }
        }
        for (const ConvexPart::Edge& edge : a_.edges) {
            if (!add_edges(edge)) {
                return false;
            }
        }
        return true;
    }

    double depth = std::numeric_limits<double>::infinity();
    Vec3 best{0.0};

private:
    bool add_edges(const ConvexPart::Edge& edge) {
        const Vec3 along = a_.along(edge);
        for (const ConvexPart::Edge& other : b_.edges) {
            if (!arcs_may_intersect(a_.normals[edge.normals[0]],
                                    a_.normals[edge.normals[1]],
                                    -b_.normals[other.normals[0]],
                                    -b_.normals[other.normals[1]])) {
                continue;
            }
            const Vec3 other_along = b_.along(other);
            const Vec3 normal = glm::cross(along, other_along);
            const double length = glm::length(normal);
            // Of parallel edges no face of the difference comes.
            if (length > kParallel * glm::length(along) * glm::length(other_along) &&
                (!add(normal / length) || !add(-normal / length))) {
                return false;
            }
        }
        return true;
    }

    const PlacedPart& a_;
    const PlacedPart& b_;
};

void keep_deeper(std::optional<SolidDepth> here,
                 std::uint32_t part_a,
                 std::uint32_t part_b,
                 std::optional<SolidDepth>& deepest) {
    if (here && (!deepest || here->depth > deepest->depth)) {
        here->part_a = part_a;
        here->part_b = part_b;
        deepest = here;
    }
}

}  // namespace

std::vector<ConvexPart> convex_parts(const geometry::MeshView& mesh) {
    // 1. A closed surface: as it is, or if vertices at one position are one. Triangles that vanish
    // by that are left out.
    std::vector<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::vector<HalfEdge> edges = opposite_pairs(triangles);
    if (edges.empty()) {
        const std::vector<std::vector<Vec3>> pose{{mesh.positions.begin(), mesh.positions.end()}};
        replace_vertices(triangles, weld(triangles, pose));
        std::erase_if(triangles, [](const Triangle& t) {
            return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
        });
        edges = opposite_pairs(triangles);
    }
    // 2. Its components.
    const std::vector<std::uint32_t> component = components_of(triangles.size(), edges);
    if (edges.empty()) {
        return {};
    }
    struct Component {
        std::vector<std::uint32_t> triangles;
        std::vector<HalfEdge> edges;
    };
    std::vector<Component> components(triangles.size());
    for (std::uint32_t i = 0; i < component.size(); ++i) {
        components[component[i]].triangles.push_back(i);
    }
    for (const HalfEdge& edge : edges) {
        components[component[edge.triangle]].edges.push_back(edge);
    }
    // 3. Each must be convex.
    std::vector<ConvexPart> parts;
    for (const Component& each : components) {
        if (each.triangles.empty()) {
            continue;
        }
        auto part = PartBuilder(mesh.positions, triangles, each.triangles).build(each.edges);
        if (!part) {
            return {};
        }
        parts.push_back(std::move(*part));
    }
    return parts;
}

std::optional<SolidDepth> penetration_depth(const ConvexPart& a,
                                            const Pose& pose_a,
                                            const ConvexPart& b,
                                            const Pose& pose_b) {
    // Relative to a vertex of a, so that the precision does not depend on where in the world they
    // are.
    const Vec3 origin = pose_a.apply(a.vertices.front());
    const PlacedPart placed_a(a, pose_a, origin);
    const PlacedPart placed_b(b, pose_b, origin);
    DepthSearch search(placed_a, placed_b);
    if (!search.run()) {
        return std::nullopt;
    }
    return SolidDepth{.depth = search.depth, .move = -search.depth * search.best};
}

std::optional<SolidDepth> penetration_depth(std::span<const ConvexPart> a,
                                            const Pose& pose_a,
                                            std::span<const ConvexPart> b,
                                            const Pose& pose_b) {
    std::optional<SolidDepth> deepest;
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        for (std::uint32_t k = 0; k < b.size(); ++k) {
            keep_deeper(penetration_depth(a[i], pose_a, b[k], pose_b), i, k, deepest);
        }
    }
    return deepest;
}

std::optional<SolidDepth> self_penetration_depth(std::span<const ConvexPart> parts,
                                                 const Pose& pose) {
    std::optional<SolidDepth> deepest;
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        for (std::uint32_t k = i + 1; k < parts.size(); ++k) {
            keep_deeper(penetration_depth(parts[i], pose, parts[k], pose), i, k, deepest);
        }
    }
    return deepest;
}

}  // namespace earshot::collision
