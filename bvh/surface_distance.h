// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"

namespace earshot::bvh {

/// How far the points of a surface are from another surface, metres.
struct SurfaceDistance {
    double lower = 0.0;  ///< the largest distance is no smaller: a point has it
    double upper = 0.0;  ///< nor larger
    /// The root of the mean of squared distances over the area, by samples where the surface was
    /// divided: its roughness against the other.
    double rms = 0.0;
};

/// The one-sided Hausdorff distance sup inf |a - b| of points a on `from` and b on `to`, with
/// upper - lower <= resolution or upper <= resolution. Triangles are halved until either all their
/// corners are close to one triangle of `to`, of whose distance, a convex function, a corner has
/// the maximum, or the triangle inequality bounds them (Guthe, Borodin and Klein 2005). Decided by
/// geometry::PreparedPoint; depends on the meshes alone. An empty `from` is at distance 0, all
/// others are infinitely far from an empty `to`. Precondition: resolution > 0.
SurfaceDistance one_sided_distance(const geometry::MeshView& from,
                                   const geometry::MeshView& to,
                                   double resolution,
                                   Executor& executor = Executor::serial());

}  // namespace earshot::bvh
