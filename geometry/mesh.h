// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <span>
#include <vector>

namespace earshot::geometry {

using Triangle = std::array<VertexId, 3>;

/// A triangle mesh that someone else owns: what every query works on. Precondition of every use:
/// vertex indices are in range and positions are finite.
struct MeshView {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
};

/// A triangle mesh that owns its arrays.
struct Mesh {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;

    MeshView view() const noexcept { return {positions, triangles}; }
};

}  // namespace earshot::geometry
