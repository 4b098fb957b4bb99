// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
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

/// The positions of a triangle's vertices, in their order.
using Corners = std::array<Vec3, 3>;

inline Corners corners(std::span<const Vec3> positions, const Triangle& triangle) noexcept {
    return {positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]};
}
inline Corners corners(const MeshView& mesh, std::size_t triangle) noexcept {
    return corners(mesh.positions, mesh.triangles[triangle]);
}

/// A triangle mesh that owns its arrays.
struct Mesh {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;

    MeshView view() const noexcept { return {positions, triangles}; }
};

inline Corners corners(const Mesh& mesh, std::size_t triangle) noexcept {
    return corners(mesh.view(), triangle);
}

}  // namespace earshot::geometry
