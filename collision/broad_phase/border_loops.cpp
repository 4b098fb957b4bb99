// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/border_loops.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::VertexId;

namespace {

struct HalfEdge {
    VertexId from, to;

    std::pair<VertexId, VertexId> edge() const noexcept { return std::minmax(from, to); }
};

/// What is left of a patch's edges when those that run both ways are taken out, by edge.
struct Border {
    std::vector<HalfEdge> edges;
    bool is_simple = true;  ///< no edge runs one way twice
};

/// Takes out what runs both ways, of edges in order.
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

Border joined(const Border& a, const Border& b) {
    std::vector<HalfEdge> edges(a.edges.size() + b.edges.size());
    std::merge(
        a.edges.begin(), a.edges.end(), b.edges.begin(), b.edges.end(), edges.begin(), is_before);
    Border border = cancelled(edges);
    border.is_simple = border.is_simple && a.is_simple && b.is_simple;
    return border;
}

Border border_of(const MovingScene& scene, const SweptForest& forest, SlotRange slots) {
    std::vector<HalfEdge> edges;
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Triangle& t = scene.triangles[forest.triangle(slot)];
        for (unsigned i = 0; i < 3; ++i) {
            edges.push_back({t[i], t[(i + 1) % 3]});
        }
    }
    std::stable_sort(edges.begin(), edges.end(), is_before);
    return cancelled(edges);
}

/// Appends the vertices along the border if it is one loop that comes to none of them twice.
/// Returns whether it is.
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

}  // namespace

BorderLoops border_loops(const MovingScene& scene, const SweptForest& forest, std::uint32_t least) {
    const std::span<const bvh::Node> nodes = forest.tree().nodes();
    BorderLoops loops;
    loops.of_node.resize(nodes.size());
    std::vector<Border> borders(nodes.size());
    for (std::uint32_t i = static_cast<std::uint32_t>(nodes.size()); i-- > 0;) {
        if (forest.mesh_of_node(i) == SweptForest::kManyMeshes) {
            continue;
        }
        const SlotRange slots = forest.slots_of_node(i);
        if (nodes[i].is_leaf()) {
            borders[i] = border_of(scene, forest, slots);
        } else {
            Border& left = borders[nodes[i].first];
            Border& right = borders[nodes[i].first + 1];
            borders[i] = joined(left, right);
            left = {};
            right = {};
        }
        const auto first = static_cast<std::uint32_t>(loops.vertices.size());
        if (slots.end - slots.begin >= least && borders[i].is_simple &&
            borders[i].edges.size() >= 3 && append_loop(borders[i].edges, loops.vertices)) {
            loops.of_node[i] = {first, static_cast<std::uint32_t>(loops.vertices.size())};
        }
    }
    return loops;
}

}  // namespace earshot::collision
