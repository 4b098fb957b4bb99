// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/normal_cones.h"

#include "earshot/collision/broad_phase/internal/contour.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

namespace {

/// Smaller nodes are traversed sooner than their normal cone is tested.
constexpr std::uint32_t kMinTriangles = 8;

double largest(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

struct HalfEdge {
    VertexId from, to;

    std::pair<VertexId, VertexId> edge() const noexcept { return std::minmax(from, to); }
};

/// The half-edges of a node's triangles whose opposite half-edge is missing, sorted by edge.
struct Border {
    std::vector<HalfEdge> edges;
    bool is_simple = true;  ///< no half-edge occurs twice
};

/// Cancels opposite half-edges, of half-edges sorted by edge.
Border cancelled(const std::vector<HalfEdge>& edges) {
    Border border;
    for (const HalfEdge& edge : edges) {
        if (border.edges.empty() || border.edges.back().edge() != edge.edge()) {
            border.edges.push_back(edge);
        } else if (border.edges.back().from != edge.from) {
            border.edges.pop_back();
        } else {
            border.is_simple = false;
        }
    }
    return border;
}

bool is_before(const HalfEdge& a, const HalfEdge& b) {
    return a.edge() < b.edge();
}

Border united(const Border& a, const Border& b) {
    std::vector<HalfEdge> edges(a.edges.size() + b.edges.size());
    std::merge(
        a.edges.begin(), a.edges.end(), b.edges.begin(), b.edges.end(), edges.begin(), is_before);
    Border border = cancelled(edges);
    border.is_simple = border.is_simple && a.is_simple && b.is_simple;
    return border;
}

Border border_of(const MovingScene& scene, const SweptBvh& swept_bvh, SlotRange slots) {
    std::vector<HalfEdge> edges;
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Triangle& t = scene.triangles[swept_bvh.triangle(slot)];
        for (unsigned i = 0; i < 3; ++i) {
            edges.push_back({t[i], t[(i + 1) % 3]});
        }
    }
    std::stable_sort(edges.begin(), edges.end(), is_before);
    return cancelled(edges);
}

/// Appends the vertices along the border if it is one loop that visits no vertex twice. Returns
/// whether it is.
bool append_loop(std::vector<HalfEdge> edges, std::vector<VertexId>& vertices) {
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.from, a.to) < std::tie(b.from, b.to);
    });
    const std::size_t first = vertices.size();
    std::size_t at = 0;
    do {
        if (vertices.size() - first == edges.size() ||
            (at + 1 < edges.size() && edges[at + 1].from == edges[at].from)) {
            break;
        }
        vertices.push_back(edges[at].from);
        const auto next = std::lower_bound(
            edges.begin(), edges.end(), edges[at].to, [](const HalfEdge& edge, VertexId vertex) {
                return edge.from < vertex;
            });
        at = static_cast<std::size_t>(next - edges.begin());
    } while (at != 0 && at < edges.size());
    if (at == 0 && vertices.size() - first == edges.size()) {
        return true;
    }
    vertices.resize(first);
    return false;
}

/// Contours of nodes: the borders of their triangles' surface.
struct Contours {
    std::vector<SlotRange> of_node;  ///< within `vertices`; empty if the border is not one loop
    std::vector<VertexId> vertices;
};

/// An edge is on the border unless another triangle of the node has its opposite half-edge. Nodes
/// of fewer than `min_triangles` triangles, and of several meshes, get no contour.
Contours find_contours(const MovingScene& scene,
                       const SweptBvh& swept_bvh,
                       std::uint32_t min_triangles) {
    const std::span<const bvh::Node> nodes = swept_bvh.tree().nodes();
    Contours contours;
    contours.of_node.resize(nodes.size());
    std::vector<Border> borders(nodes.size());
    for (std::uint32_t i = static_cast<std::uint32_t>(nodes.size()); i-- > 0;) {
        if (swept_bvh.mesh_of_node(i) == SweptBvh::kMixedMeshes) {
            continue;
        }
        const SlotRange slots = swept_bvh.slots_of_node(i);
        if (nodes[i].is_leaf()) {
            borders[i] = border_of(scene, swept_bvh, slots);
        } else {
            Border& left = borders[nodes[i].first];
            Border& right = borders[nodes[i].first + 1];
            borders[i] = united(left, right);
            left = {};
            right = {};
        }
        const auto first = static_cast<std::uint32_t>(contours.vertices.size());
        if (slots.end - slots.begin >= min_triangles && borders[i].is_simple &&
            borders[i].edges.size() >= 3 && append_loop(borders[i].edges, contours.vertices)) {
            contours.of_node[i] = {first, static_cast<std::uint32_t>(contours.vertices.size())};
        }
    }
    return contours;
}

}  // namespace

void NormalCones::build(const MovingScene& scene, const SweptBvh& swept_bvh) {
    Contours contours = find_contours(scene, swept_bvh, kMinTriangles);
    contour_of_node_ = std::move(contours.of_node);
    vertices_ = std::move(contours.vertices);
    changed_meshes_.reset();
}

void NormalCones::update(const MovingScene& scene, const SweptBvh& swept_bvh, Executor& executor) {
    normals_.resize(scene.triangles.size());
    const auto slots = ranges_of(changed_meshes_.take(scene),
                                 [&](std::uint32_t mesh) { return swept_bvh.slots_of_mesh(mesh); });
    for_each_index(slots, 4096, executor, [&](std::uint32_t slot) {
        const MovingCorners corners = scene.corners_of(scene.triangles[swept_bvh.triangle(slot)]);
        const Vec3 a = corners.begin[1] - corners.begin[0];
        const Vec3 b = corners.begin[2] - corners.begin[0];
        const Vec3 c = corners.end[1] - corners.end[0];
        const Vec3 d = corners.end[2] - corners.end[0];
        normals_[slot].coefficients = {
            glm::cross(a, b), 0.5 * (glm::cross(a, d) + glm::cross(c, b)), glm::cross(c, d)};
        normals_[slot].size = std::max(largest(a), largest(c)) * std::max(largest(b), largest(d));
    });
    sums_.resize(normals_.size() + 1);
    for (std::size_t slot = slots.empty() ? normals_.size() : slots.front().begin;
         slot < normals_.size();
         ++slot) {
        sums_[slot + 1] = sums_[slot] + normals_[slot].coefficients[1];
    }
}

bool NormalCones::passes_cone_test(SlotRange slots, const Vec3& direction) const noexcept {
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Normals& normals = normals_[slot];
        // Far above the rounding error of products of this size, and of the direction.
        const double error = 0x1p-40 * normals.size + 1e-290;
        for (const Vec3& normal : normals.coefficients) {
            if (!(glm::dot(normal, direction) > error)) {
                return false;
            }
        }
    }
    return true;
}

bool NormalCones::is_contact_free(const MovingScene& scene,
                                  const SweptBvh& swept_bvh,
                                  std::uint32_t node) const {
    const SlotRange contour = contour_of_node_[node];
    if (contour.begin == contour.end) {
        return false;
    }
    const SlotRange slots = swept_bvh.slots_of_node(node);
    // The axis of the cone: the mean of the normals half-way through the step.
    const Vec3 sum = sums_[slots.end] - sums_[slots.begin];
    const Vec3 direction = geometry::normalized_or_zero(sum);
    return passes_cone_test(slots, direction) &&
           !contour_self_intersects(
               scene,
               std::span(vertices_).subspan(contour.begin, contour.end - contour.begin),
               direction);
}

}  // namespace earshot::collision
