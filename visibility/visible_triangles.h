// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/visible_triangle_set.h"

namespace earshot::visibility {

// The triangles that are visible from a point. Each triangle that is reported is proved by a
// direction in which it is the bvh::closest_hit(): the set is a subset of the true one (it is
// "aggressive"). What it may lack, and why that is little, is told in
// docs/algorithms/visibility.md. Excluded triangles are treated as absent, and so are triangles
// without area. Both sides of a triangle are visible. From a point on a triangle
// only that triangle and what lies in its plane is visible; from a point that is not finite, or in
// an empty mesh, nothing is.

/// The set of triangles visible from `point`. The first pass is an item buffer: one ray through
/// each pixel of the six faces of a cube around the point. The refinement then samples between
/// pixels: the interval between neighbouring pixels with different triangles is subdivided, the
/// border of every triangle found is followed (adaptive border sampling; Wonka et al. 2006), and a
/// ray is aimed at the centroid of every triangle that is still missing, so that each triangle
/// whose centroid is visible is found. The result is the same for any tree and executor.
VisibleTriangles visible_triangles(const bvh::MeshBvh& bvh,
                                   const geometry::Vec3& point,
                                   const VisibleTrianglesOptions& options = {},
                                   Executor& executor = Executor::serial(),
                                   Progress* progress = nullptr);

}  // namespace earshot::visibility
