// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/internal/surface_samples.h"
#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::geometry {

/// Calls visit(point) for points that part the segment into equal pieces no shorter than `spacing`,
/// at most `max_count` of them.
template <typename Visit>
void for_points_within(
    const Vec3& from, const Vec3& to, double spacing, int max_count, Visit&& visit) {
    const Vec3 along = to - from;
    int pieces = 1;
    while (pieces <= max_count &&
           glm::dot(along, along) > (pieces + 1.0) * (pieces + 1.0) * spacing * spacing) {
        ++pieces;
    }
    for (int i = 1; i < pieces; ++i) {
        visit(from + static_cast<double>(i) / pieces * along);
    }
}

/// The curves of a surface that is being simplified: its borders and the lines between two labels.
/// Curves meet in junctions, which stay. Half-edge collapses move a vertex of a curve along it.
class SurfaceCurves {
public:
    /// Of an oriented manifold.
    SurfaceCurves(const MeshView& mesh,
                  std::span<const std::uint32_t> labels,
                  int samples_per_edge);

    /// Whether curves end or meet in the vertex, so that it must stay.
    bool is_junction(VertexId vertex) const noexcept { return is_junction_[vertex]; }

    bool is_on_curve(VertexId vertex) const noexcept { return pieces_of_[vertex][0] != kNone; }

    /// Whether the vertex is on no curve or `to` is the next vertex of its curve.
    bool allows(VertexId vertex, VertexId to) const noexcept;

    /// What moving the vertex to the next one does to its curve: distance squared by length
    /// squared, as quadrics weigh squared distances by areas. 0 for a vertex on no curve.
    double bend_cost(VertexId vertex, VertexId to) const noexcept;

    /// Whether the samples of the curve keep within the distance if the vertex moves to the next.
    bool fits(VertexId vertex, VertexId to, double max_distance);

    /// Moves the vertex to the next one. Precondition: fits() held for these two just before, or
    /// the vertex is on no curve.
    void collapse(VertexId vertex, VertexId to);

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;
    using Piece = std::uint32_t;

    void add_piece(VertexId a, VertexId b);
    VertexId other_end(Piece piece, VertexId vertex) const noexcept {
        return ends_[piece][0] == vertex ? ends_[piece][1] : ends_[piece][0];
    }
    /// The piece from the vertex that does not lead to `to`, and that which does. Precondition:
    /// allows(vertex, to), on a curve.
    std::pair<Piece, Piece> other_and_same(VertexId vertex, VertexId to) const noexcept;

    std::span<const Vec3> positions_;
    std::vector<std::array<VertexId, 2>> ends_;       // per piece
    std::vector<std::array<Piece, 2>> pieces_of_;     // per vertex; of a junction any two
    std::vector<std::uint32_t> piece_counts_;         // per vertex
    std::vector<bool> is_junction_;                   // per vertex
    SurfaceSamples samples_;                          // elements: pieces
    std::array<SurfaceSamples::Element, 2> removed_;  // of fits(), for collapse()
    SurfaceSamples::Moves moves_;
};

}  // namespace earshot::geometry
