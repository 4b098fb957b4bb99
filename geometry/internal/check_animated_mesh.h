// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/animated_mesh.h"

namespace earshot::geometry {

/// Throws Error for the first thing that the constructor of AnimatedMesh promises to refuse.
void check_animated_mesh(std::span<const Node> nodes,
                         std::span<const Skin> skins,
                         std::span<const Part> parts,
                         std::span<const Triangle> triangles);

}  // namespace earshot::geometry
