// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/clean.h"

#include <span>
#include <vector>

namespace earshot::geometry {

/// Sets the counts of edges, holes and T-junctions. Precondition: the triangles are welded, and
/// each has an area.
void count_edges(std::span<const Triangle> triangles,
                 std::span<const Vec3> positions,
                 CleanReport& report);

/// The vertices of open edges that lie inside another open edge (see CleanReport::t_junctions), in
/// the order of the edges that they lie in. Precondition as for count_edges().
std::vector<VertexId> find_t_junctions(std::span<const Triangle> triangles,
                                       std::span<const Vec3> positions);

}  // namespace earshot::geometry
