// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/aabb.h"
#include "earshot/visibility/region.h"
#include "earshot/visibility/visible_sets.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace earshot::visibility {

/// Parameters of build_visible_sets().
struct VisibleSetsOptions {
    /// Into at most so many cells the region is divided, where visibility changes; 0: see `grid`.
    std::size_t max_cells = 0;
    /// Boxes along each axis that the region is divided into instead; empty: it is one cell.
    std::optional<std::array<std::uint32_t, 3>> grid{};
    std::size_t triangles_per_object = 1;     ///< at most; > 0
    std::optional<std::uint64_t> max_rays{};  ///< empty: 10 million, or 20 million for cells
    /// Sampling ends when a million rays found fewer triangles than this (empty: 50) or, for cells,
    /// when no set grew by more objects in 5 million rays (empty: 5).
    std::optional<std::uint64_t> until{};
    /// Of the validation batch; empty: a tenth of the rays, at least 65,536; 0: it is left out.
    std::optional<std::uint64_t> validation_rays{};
    std::size_t segments = 200'000;  ///< random segments that show where to divide
    bool skip_solids = false;        ///< SegmentSampling::skip_solids
    Progress* progress = nullptr;    ///< receives "view cells", "rays" and "validation rays"
    Interrupt interrupt{};           ///< ends the sampling, whose sets then are smaller
};

/// The visible sets of a region's cells, and their validation. A region that is one cell is sampled
/// by sample_region(), all cells of others by sample_cells(), whose sets come with the history of
/// merging them. `provenance` holds scene, time, digest and seed; rays and validation are set. The
/// sets depend on the arguments alone, unless sampling is interrupted. Throws Error as the
/// functions of these steps do. Precondition: not both max_cells and grid.
VisibleSets build_visible_sets(const bvh::MeshBvh& bvh,
                               const ViewRegion& region,
                               const VisibleSetsOptions& options,
                               SetsProvenance provenance,
                               Executor& executor = Executor::serial());

/// The box of a mesh as a region; a point for a mesh without triangles.
ViewRegion region_of(const geometry::Aabb& box);

}  // namespace earshot::visibility
