// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// Edges at which a surface has a border or a crease, changes its label or branches: what a line
/// drawing shows of a mesh. They part it into patches, which are flat or smooth.
struct FeatureEdges {
    std::vector<std::array<VertexId, 2>> edges;  ///< vertices of the mesh, ascending
    std::vector<std::uint32_t> first;            ///< per edge, and the number of `triangles`
    std::vector<TriangleId> triangles;           ///< beside the edges, ascending per edge
    /// Per triangle of the mesh; patches are numbered by their lowest triangle. A duplicate belongs
    /// to the patch of the triangle that takes part in its place, a degenerate triangle to none
    /// but its own.
    std::vector<std::uint32_t> patch_of_triangle;

    std::span<const TriangleId> beside(std::size_t edge) const noexcept {
        return std::span(triangles).subspan(first[edge], first[edge + 1] - first[edge]);
    }
};

/// The cosine between the normals of two triangles below which their common edge is a crease:
/// 2.6 degrees, between the facets of a fine cylinder and the corners of furniture.
inline constexpr double kCreaseCosine = 0.999;

/// Finds the feature edges of a mesh as clean() takes it. Precondition as for clean(), and
/// labels.size() == triangles.size(). O(n log n).
FeatureEdges find_feature_edges(const MeshView& mesh,
                                std::span<const std::uint32_t> labels,
                                double crease_cosine = kCreaseCosine,
                                Executor& executor = Executor::serial());

}  // namespace earshot::geometry
