// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::geometry {

/// 3 * triangle + corner: the edge from that corner of the triangle to the next one.
using HalfEdgeId = std::uint32_t;

inline constexpr HalfEdgeId kNoHalfEdge = std::numeric_limits<HalfEdgeId>::max();

constexpr TriangleId triangle_of(HalfEdgeId h) noexcept {
    return h / 3;
}

/// The half-edge that starts where `h` ends, in the same triangle.
constexpr HalfEdgeId next_in_triangle(HalfEdgeId h) noexcept {
    return h % 3 == 2 ? h - 2 : h + 1;
}

inline VertexId start_of(std::span<const Triangle> triangles, HalfEdgeId h) noexcept {
    return triangles[h / 3][h % 3];
}

inline VertexId end_of(std::span<const Triangle> triangles, HalfEdgeId h) noexcept {
    return start_of(triangles, next_in_triangle(h));
}

/// Every edge of a mesh with the triangles that meet in it, however many and whichever way round:
/// unlike a half-edge mesh it takes any input.
class EdgeTable {
public:
    /// `triangles` name welded vertices below `vertex_count`. Linear time but for vertices of very
    /// high degree. Precondition: fewer than 2^32 / 3 triangles, no vertex twice in one triangle.
    EdgeTable(std::span<const Triangle> triangles, std::size_t vertex_count);

    std::size_t size() const noexcept { return first_.size() - 1; }

    /// The half-edges of edge `e`, ascending. Edges are ordered by their vertices.
    std::span<const HalfEdgeId> uses(std::size_t e) const noexcept {
        return std::span(half_edges_).subspan(first_[e], first_[e + 1] - first_[e]);
    }

private:
    std::vector<HalfEdgeId> half_edges_;
    std::vector<std::uint32_t> first_;
};

/// Per half-edge the one that runs the other way along the same edge, if the edge has just these
/// two; else kNoHalfEdge.
std::vector<HalfEdgeId> twins_of(const EdgeTable& edges, std::span<const Triangle> triangles);

}  // namespace earshot::geometry
