// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <span>
#include <utility>
#include <vector>

namespace earshot::geometry {

/// Pairs (later, earlier) of triangles whose corners agree within the tolerance, ascending; of
/// triangles whose height is no larger than a few tolerances none.
std::vector<std::pair<TriangleId, TriangleId>> find_near_duplicates(
    const MeshView& mesh, std::span<const TriangleId> candidates, double tolerance);

}  // namespace earshot::geometry
