// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::geometry {

/// Which ear is cut off next: the first one from where the last was cut, or the one with the
/// shortest diagonal (of equals the first), which makes slivers rare.
enum class EarOrder { successive, shortest_diagonal };

/// A polygon's border as indices of points.
using IndexLoop = std::vector<std::size_t>;

/// Triangles, counter-clockwise, that fill a polygon: loops[0] is its outline, counter-clockwise,
/// the others are its holes, clockwise; no loop crosses or touches another. Ear clipping (Meisters
/// 1975) decided by orient2d(), whose magnitudes apply. Every corner is used and no point is made,
/// so neighbours that share corners fit without T-junctions. Where an outline crosses itself and
/// has no ear, any corner is cut off: the number of triangles is always that of all corners, minus
/// 2, plus 2 per hole. Fewer than three corners give nothing. O(n^2) for n corners of an outline;
/// joining holes to it takes more.
std::vector<std::array<std::size_t, 3>> triangulate(std::span<const glm::dvec2> points,
                                                    std::vector<IndexLoop> loops,
                                                    EarOrder order);

/// Triangles, of the same winding, of a simple polygon in space: ears in the order of its corners,
/// in its projection along the axis closest to its area vector. `polygon` holds indices of
/// positions.
std::vector<Triangle> triangulate(std::span<const Vec3> positions,
                                  std::span<const VertexId> polygon);

}  // namespace earshot::geometry
