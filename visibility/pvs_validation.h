// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/exclusion_mask.h"
#include "earshot/visibility/missed_share.h"
#include "earshot/visibility/objects.h"
#include "earshot/visibility/view_cells.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Parameters of validate_pvs().
struct ValidationOptions {
    std::uint64_t seed = 1;
    std::uint64_t rays = std::uint64_t{1} << 16U;
    ExclusionMask excluded{};      ///< the one that the sets were sampled with
    Progress* progress = nullptr;  ///< receives "validation rays"
};

/// Measures what sampled sets miss, by fresh rays that had no part in the sampling: independent
/// viewpoints uniform in the region and directions uniform on the sphere. A ray is missed if its
/// closest hit is an object that the set of its viewpoint's cell lacks (the pixel error of Bittner
/// et al. 2009, section 5.3). Ray i is a function of seed and i alone; the result does not depend
/// on the executor. Precondition: there is a set
/// per cell.
MissedShare validate_pvs(const bvh::MeshBvh& bvh,
                         const Objects& objects,
                         const ViewCells& cells,
                         std::span<const std::vector<ObjectId>> sets,
                         const ValidationOptions& options = {},
                         Executor& executor = Executor::serial());

}  // namespace earshot::visibility
