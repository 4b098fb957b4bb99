// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace earshot::bvh {

// Queries over a tree whose primitive i is triangle i of the mesh, in the box triangle_boxes()
// gives it. Distances are decided by geometry::PreparedPoint, so answers depend on the mesh alone,
// never on the tree. No triangle is found from a point with a coordinate that is not finite, and
// none within a distance that is negative or not a number.

/// The closest point of the mesh within `max_distance` metres (inclusive); of triangles at the same
/// distance the lowest TriangleId. Does not allocate.
std::optional<geometry::ClosestPoint> closest_point(
    const Tree& tree,
    const geometry::MeshView& mesh,
    const geometry::Vec3& point,
    double max_distance = std::numeric_limits<double>::infinity()) noexcept;

/// The closest points of the `count` closest triangles within `max_distance` metres (inclusive): by
/// distance, then by TriangleId. Fewer if there are no more.
std::vector<geometry::ClosestPoint> closest_triangles(
    const Tree& tree,
    const geometry::MeshView& mesh,
    const geometry::Vec3& point,
    std::size_t count,
    double max_distance = std::numeric_limits<double>::infinity());

}  // namespace earshot::bvh
