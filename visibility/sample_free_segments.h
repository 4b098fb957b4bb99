// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/free_segments.h"

#include <cstdint>
#include <vector>

namespace earshot::visibility {

/// Parameters of sample_free_segments().
struct SegmentSampling {
    std::uint64_t seed = 1;
    std::uint64_t first = 0;      ///< number of the first sample: to continue an earlier call
    std::size_t count = 1000000;  ///< samples drawn; those that hit no triangle are left out
    /// For closed surfaces whose fronts face the free space, counter-clockwise: a sample that
    /// starts inside a solid moves along its line until it has left the solid, and no segment lies
    /// in a solid. Of other meshes, much is left out.
    bool skip_solids = false;
    ExclusionMask excluded{};  ///< triangles that are treated as absent
};

/// Maximal free segments through points uniform in the region, with directions uniform on the
/// sphere, that end at a triangle on at least one side; in the order of the samples (GameTools
/// 2007, the sampling of view cells). Sample i is a function of seed and i alone. Precondition: the
/// tree was built over or refitted to this mesh. Throws Error as validate(region).
std::vector<FreeSegment> sample_free_segments(const bvh::MeshBvh& bvh,
                                              const ViewRegion& region,
                                              const SegmentSampling& sampling = {},
                                              Executor& executor = Executor::serial());

}  // namespace earshot::visibility
