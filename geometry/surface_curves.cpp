// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/surface_curves.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/topology.h"

#include <glm/geometric.hpp>

namespace earshot::geometry {

SurfaceCurves::SurfaceCurves(const MeshView& mesh,
                             std::span<const std::uint32_t> labels,
                             int samples_per_edge)
    : positions_(mesh.positions),
      pieces_of_(mesh.positions.size(), {kNone, kNone}),
      piece_counts_(mesh.positions.size(), 0),
      is_junction_(mesh.positions.size(), false),
      samples_({}) {
    const EdgeTable edges(mesh.triangles, mesh.positions.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const std::span<const HalfEdgeId> uses = edges.uses(e);
        if (uses.size() == 1 || labels[triangle_of(uses[0])] != labels[triangle_of(uses[1])]) {
            add_piece(start_of(mesh.triangles, uses[0]), end_of(mesh.triangles, uses[0]));
        }
    }
    for (VertexId v = 0; v < piece_counts_.size(); ++v) {
        is_junction_[v] = piece_counts_[v] != 0 && piece_counts_[v] != 2;
    }
    samples_ = SurfaceSamples(std::vector<std::uint32_t>(ends_.size(), 0));
    for (Piece piece = 0; piece < ends_.size(); ++piece) {
        const Vec3& a = positions_[ends_[piece][0]];
        const Vec3& b = positions_[ends_[piece][1]];
        samples_.add(piece, a);
        samples_.add(piece, b);
        for_points_within(
            a, b, 0.0, samples_per_edge, [&](const Vec3& point) { samples_.add(piece, point); });
    }
}

void SurfaceCurves::add_piece(VertexId a, VertexId b) {
    const auto piece = static_cast<Piece>(ends_.size());
    ends_.push_back({a, b});
    for (const VertexId vertex : {a, b}) {
        if (piece_counts_[vertex] < 2) {
            pieces_of_[vertex][piece_counts_[vertex]] = piece;
        }
        ++piece_counts_[vertex];
    }
}

std::pair<SurfaceCurves::Piece, SurfaceCurves::Piece> SurfaceCurves::other_and_same(
    VertexId vertex, VertexId to) const noexcept {
    const auto& [a, b] = pieces_of_[vertex];
    return other_end(a, vertex) == to ? std::pair(b, a) : std::pair(a, b);
}

bool SurfaceCurves::allows(VertexId vertex, VertexId to) const noexcept {
    if (!is_on_curve(vertex)) {
        return true;
    }
    const auto& [a, b] = pieces_of_[vertex];
    return !is_junction_[vertex] && (other_end(a, vertex) == to || other_end(b, vertex) == to);
}

double SurfaceCurves::bend_cost(VertexId vertex, VertexId to) const noexcept {
    if (!is_on_curve(vertex)) {
        return 0.0;
    }
    const Vec3& before = positions_[other_end(other_and_same(vertex, to).first, vertex)];
    const Vec3& after = positions_[to];
    const Vec3 along = after - before;
    return squared_distance(positions_[vertex], {before, after, after}) * glm::dot(along, along);
}

bool SurfaceCurves::fits(VertexId vertex, VertexId to, double max_distance) {
    if (!is_on_curve(vertex)) {
        return true;
    }
    const auto [other, same] = other_and_same(vertex, to);
    const VertexId before = other_end(other, vertex);
    removed_ = {other, same};
    const SurfaceSamples::Made made{
        .element = other, .corners = {positions_[before], positions_[to], positions_[to]}};
    return before != to && samples_.fits(removed_, {&made, 1}, max_distance, moves_);
}

void SurfaceCurves::collapse(VertexId vertex, VertexId to) {
    if (!is_on_curve(vertex)) {
        return;
    }
    samples_.move(removed_, moves_);
    const auto [other, same] = other_and_same(vertex, to);
    EARSHOT_ASSERT(other == removed_[0] && same == removed_[1]);
    ends_[other] = {other_end(other, vertex), to};
    for (Piece& piece : pieces_of_[to]) {
        piece = piece == same ? other : piece;
    }
    pieces_of_[vertex] = {kNone, kNone};
}

}  // namespace earshot::geometry
