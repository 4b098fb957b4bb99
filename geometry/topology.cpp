// SPDX-License-Identifier: MIT
#include "earshot/geometry/topology.h"

#include "earshot/base/assert.h"

#include <algorithm>

namespace earshot::geometry {
namespace {

/// The farther vertex and the half-edge in one number that sorts by both.
constexpr std::uint64_t packed(VertexId higher, HalfEdgeId h) noexcept {
    return (std::uint64_t{higher} << 32) | h;
}

constexpr VertexId higher_of(std::uint64_t entry) noexcept {
    return static_cast<VertexId>(entry >> 32);
}

}  // namespace

EdgeTable::EdgeTable(std::span<const Triangle> triangles, std::size_t vertex_count) {
    EARSHOT_ASSERT(triangles.size() < kNoHalfEdge / 3);
    const auto half_edge_count = static_cast<HalfEdgeId>(3 * triangles.size());

    // Counting sort by the lower vertex, then each vertex's few edges by the higher one.
    std::vector<std::uint32_t> begin(vertex_count + 1, 0);
    const auto lower_of = [&](HalfEdgeId h) {
        return std::min(start_of(triangles, h), end_of(triangles, h));
    };
    for (HalfEdgeId h = 0; h < half_edge_count; ++h) {
        ++begin[lower_of(h) + 1];
    }
    for (std::size_t v = 0; v < vertex_count; ++v) {
        begin[v + 1] += begin[v];
    }
    std::vector<std::uint64_t> entries(half_edge_count);
    std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
    for (HalfEdgeId h = 0; h < half_edge_count; ++h) {
        const VertexId higher = std::max(start_of(triangles, h), end_of(triangles, h));
        entries[end[lower_of(h)]++] = packed(higher, h);
    }

    half_edges_.reserve(half_edge_count);
    for (std::size_t v = 0; v < vertex_count; ++v) {
        std::sort(entries.begin() + begin[v], entries.begin() + begin[v + 1]);
        for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
            if (i == begin[v] || higher_of(entries[i]) != higher_of(entries[i - 1])) {
                first_.push_back(i);
            }
            half_edges_.push_back(static_cast<HalfEdgeId>(entries[i]));
        }
    }
    first_.push_back(half_edge_count);
}

std::vector<HalfEdgeId> twins_of(const EdgeTable& edges, std::span<const Triangle> triangles) {
    std::vector<HalfEdgeId> twins(3 * triangles.size(), kNoHalfEdge);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const std::span<const HalfEdgeId> uses = edges.uses(e);
        if (uses.size() == 2 && start_of(triangles, uses[0]) == end_of(triangles, uses[1])) {
            twins[uses[0]] = uses[1];
            twins[uses[1]] = uses[0];
        }
    }
    return twins;
}

}  // namespace earshot::geometry
