// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Connected triangles (across edges; vertices of one position are one) in which every edge has an
/// even number of triangles: they part space into sides, whatever their orientation.
struct ClosedSurface {
    std::vector<geometry::TriangleId> triangles;  ///< ascending
    geometry::Vec3 lower{0.0};                    ///< of its bounding box, metres
    geometry::Vec3 upper{0.0};
};

/// All closed surfaces of a mesh, in the order of their first triangle. O(n log n).
std::vector<ClosedSurface> closed_surfaces(std::span<const geometry::Vec3> positions,
                                           std::span<const geometry::Triangle> triangles);

/// Whether `point` is inside: a half-line from it crosses the surface an odd number of times, by
/// the majority of three directions. In double precision, without exact ties: of a point on the
/// surface the answer is either. O(n).
bool is_inside(const ClosedSurface& surface,
               std::span<const geometry::Vec3> positions,
               std::span<const geometry::Triangle> triangles,
               const geometry::Vec3& point);

/// Whether `point` lies on the surface, within `tolerance` metres. O(n).
bool is_on(const ClosedSurface& surface,
           std::span<const geometry::Vec3> positions,
           std::span<const geometry::Triangle> triangles,
           const geometry::Vec3& point,
           double tolerance);

}  // namespace earshot::propagation
