// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// A mesh that stands for another one.
struct SimplifiedMesh {
    Mesh mesh;
    std::vector<TriangleId> origins;  ///< per triangle one of the original that it replaces
};

/// Triangulates every facet (find_facets()) anew, by as few triangles as its corners allow:
/// vertices inside facets vanish, and so do those within coplanar_tolerance() of straight borders.
/// Facets that share a border keep the same vertices there. A facet stays as it is where it has
/// more than kMaxFacetCorners corners, where its borders touch each other, or where new triangles
/// would not have its area. Precondition: a clean mesh (clean.h) whose equal vertices are one;
/// labels.size() == triangles.size().
SimplifiedMesh merge_planar_regions(const MeshView& mesh,
                                    std::span<const std::uint32_t> labels,
                                    Executor& executor = Executor::serial());

/// Ears are cut off in the square of the number of corners.
inline constexpr std::size_t kMaxFacetCorners = 500;

}  // namespace earshot::geometry
