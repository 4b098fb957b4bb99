// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::collision {

/// Which of a triangle's corners and edges are its own: bit i for corner i, bit 3 + i for the edge
/// from corner i to the next. A vertex or edge belongs to the first triangle that has it, so the
/// own elements of all triangles are all elements, each once. A triangle that names a vertex twice
/// owns nothing twice.
std::vector<std::uint8_t> own_elements(std::span<const geometry::Triangle> triangles);

/// All corners, and all edges between two vertices: elements come as often as triangles have them.
std::vector<std::uint8_t> all_elements(std::span<const geometry::Triangle> triangles);

}  // namespace earshot::collision
