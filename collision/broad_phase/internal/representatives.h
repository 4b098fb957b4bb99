// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::collision {

/// Representative triangles (Curtis et al. 2008): which corners and edges each triangle represents,
/// bit i for corner i, bit 3 + i for the edge from corner i to the next. A vertex or edge is
/// represented by the first triangle that has it, so that every one is represented once. A triangle
/// that names a vertex twice represents nothing twice.
std::vector<std::uint8_t> representative_features(std::span<const geometry::Triangle> triangles);

/// Every triangle represents all its corners, and all its edges between two vertices.
std::vector<std::uint8_t> all_features(std::span<const geometry::Triangle> triangles);

}  // namespace earshot::collision
