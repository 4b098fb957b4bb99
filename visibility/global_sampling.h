// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/global_pvs.h"
#include "earshot/visibility/view_cells.h"

namespace earshot::visibility {

/// Samples the sets of all cells at the same time (Bittner et al. 2009, adaptive global visibility
/// sampling): a maximal free segment adds the objects at its ends to the PVS of every cell that it
/// pierces, and the distributions are mixed by their recent contribution per ray. Excluded
/// triangles are treated as absent, and so are triangles without area. The sets depend on the
/// arguments alone, unless sampling is interrupted. Throws Error if the sets would take more than 4
/// GiB while they grow (a bit for every cell and object), or if no distribution is allowed.
/// Precondition: objects are of the triangles of the hierarchy's mesh.
GlobalPvs sample_cells(const bvh::MeshBvh& bvh,
                       const Objects& objects,
                       const ViewCells& cells,
                       const GlobalSamplingOptions& options = {},
                       Executor& executor = Executor::serial());

}  // namespace earshot::visibility
