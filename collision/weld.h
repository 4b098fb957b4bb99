// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/animated_mesh.h"
#include "earshot/geometry/mesh.h"

#include <span>
#include <vector>

namespace earshot::collision {

// Exporters split vertices where normals, texture coordinates, colours or materials change. Such
// copies are at one position at every instant, but as different vertices the triangles on both
// sides of a seam count as in contact. Welding names one vertex for all copies: the one of the
// lowest index. Every copy of a vertex that was split is on a border, an edge of one triangle only;
// other vertices are left alone, so that closed surfaces of one mesh that touch each other still
// do. 0 and -0 are one coordinate.

/// For each vertex the one that stands for it: itself, or, on a border, the first one on a border
/// that is at the same position in every pose. Precondition: all poses have the same number of
/// vertices, and triangles name no others. O(n log n).
std::vector<geometry::VertexId> weld(std::span<const geometry::Triangle> triangles,
                                     std::span<const std::vector<geometry::Vec3>> poses);

/// The same of an animated mesh: vertices are one that are of one mesh and move with the same node,
/// skin and weights from the same position, and so are at the same position at every instant.
std::vector<geometry::VertexId> weld(const geometry::AnimatedMesh& mesh);

/// Replaces the vertices of triangles by those that stand for them.
void replace_vertices(std::span<geometry::Triangle> triangles,
                      std::span<const geometry::VertexId> representatives) noexcept;

}  // namespace earshot::collision
