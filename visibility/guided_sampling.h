// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/region.h"
#include "earshot/visibility/region_pvs.h"

namespace earshot::visibility {

/// The triangles that are visible from some point of a region (Wonka et al. 2006, guided visibility
/// sampling): random rays from the region's boundary; adaptive border sampling around each triangle
/// that is found; and reverse sampling past its occluders. A region may be flat or a point.
/// Triangles that reach into the region are visible. Excluded triangles are treated as absent, and
/// so are triangles without area. The set depends on mesh, region and options alone, unless it is
/// interrupted. Throws Error as validate(region). Precondition: the tree was built over or refitted
/// to this mesh.
RegionPvs sample_region(const bvh::MeshBvh& bvh,
                        const ViewRegion& region,
                        const GuidedSamplingOptions& options = {},
                        Executor& executor = Executor::serial());

}  // namespace earshot::visibility
