// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <array>
#include <cstdint>
#include <vector>

namespace earshot::scenes {

/// The geometry of a node as glTF stores it: shared vertices in single precision, and triangles
/// by material.
struct IndexedMesh {
    std::vector<std::array<float, 3>> positions;                       ///< ascending, each once
    std::vector<std::vector<std::array<float, 3>>> displacements;      ///< per morph target
    std::vector<std::vector<std::array<std::uint32_t, 3>>> triangles;  ///< per material

    std::size_t triangle_count() const;
};

/// Splits every quadrilateral into tessellation x tessellation smaller ones (a triangle into
/// tessellation^2), shares the vertices and cuts quadrilaterals in two. A divided edge gives the
/// same points from both sides. Precondition: tessellation >= 1.
IndexedMesh index_faces(const DraftNode& node, std::size_t material_count, int tessellation);

}  // namespace earshot::scenes
