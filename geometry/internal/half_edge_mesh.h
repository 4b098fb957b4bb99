// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/topology.h"

#include <cstddef>
#include <cstdint>
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

/// A surface to decimate: an oriented manifold with border whose vertices are in triangles.
struct DecimationInput {
    MeshView mesh;
    std::span<const std::uint32_t> labels;  ///< per triangle
    std::vector<bool> is_locked;            ///< per vertex: stays where it is
};

struct DecimationLimits {
    double max_distance = 0.0;      ///< of samples of the surface from what replaces them, metres
    double max_angle = 0.0;         ///< opening of the cone of normals that become one, radians
    double max_aspect_ratio = 0.0;  ///< of what is made, unless it was worse before
    int samples_per_edge = 0;       ///< inside an edge at most
};

/// A triangle that is left.
struct DecimatedTriangle {
    Triangle corners;       ///< vertices of the input
    TriangleId origin = 0;  ///< the triangle of the input that it was, which has its label
    std::vector<VertexId> samples{};  ///< vertices of the input that are gone and closest to it
};

/// Collapses half-edges with OpenMesh's decimation modules: in the order of quadric errors (Garland
/// and Heckbert 1997), within bounds on the deviation and the turn of normals and on the aspect
/// ratio. Vertices stay where they are or vanish. Borders and the lines between two labels keep
/// within `max_distance` of what they were, as points on them, vertices and points within edges do.
/// Throws Error if the triangles are no oriented manifold.
std::vector<DecimatedTriangle> decimate(const DecimationInput& input,
                                        const DecimationLimits& limits);

}  // namespace earshot::geometry
