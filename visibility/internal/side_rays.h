// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/visibility/triangle_sides.h"

#include <cstdint>
#include <optional>
#include <span>

namespace earshot::visibility {

/// The unit normal of a side, into the half-space before it.
geometry::Vec3 normal_of(const bvh::MeshBvh& bvh, SideId side);

/// The side of the triangle that a ray hits. A ray in the plane hits the front.
SideId side_hit(const bvh::MeshBvh& bvh, const geometry::Ray& ray, geometry::TriangleId triangle);

/// How far from a surface rays start, metres: far above the rounding of a point on it, far below
/// what files resolve.
double ray_offset(const bvh::MeshBvh& bvh);

/// A ray from a random point of a side, uniform over its area but for a margin along its border, in
/// a direction distributed by Lambert's law. Uses four random numbers of `seed`: the streams
/// `stream` ... `stream` + 3 at `index`.
geometry::Ray random_side_ray(const bvh::MeshBvh& bvh,
                              SideId side,
                              std::uint64_t seed,
                              std::uint64_t stream,
                              std::uint64_t index);

/// A direction about a unit normal, by Lambert's law, from two uniform numbers.
geometry::Vec3 cosine_direction(const geometry::Vec3& normal, double u, double v);

/// The closest hit of rays that start on triangles, which they do not hit.
void closest_hits(const bvh::MeshBvh& bvh,
                  std::span<const geometry::Ray> rays,
                  std::span<const geometry::TriangleId> origins,
                  std::span<std::optional<geometry::Hit>> hits,
                  Executor& executor);

}  // namespace earshot::visibility
