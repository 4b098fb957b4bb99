// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/topology.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::geometry {

/// The borders of an oriented manifold mesh.
struct HalfEdgeBorders {
    /// Each loop as the half-edges of triangles that lie along it, in the order in which the border
    /// runs: opposite to the half-edges' own direction.
    std::vector<std::vector<HalfEdgeId>> loops;
};

/// Walks the borders of the mesh with OpenMesh. Throws Error if the triangles are no oriented
/// manifold.
HalfEdgeBorders find_borders(std::span<const Triangle> triangles, std::size_t vertex_count);

}  // namespace earshot::geometry
