// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/free_segments.h"

#include <cstdint>
#include <vector>

namespace earshot::visibility {

struct SegmentSampling {
    std::uint64_t seed = 1;
    std::uint64_t first = 0;      ///< the first sample's number: to go on where others stopped
    std::size_t count = 1000000;  ///< samples drawn; those that meet nothing are left out
    /// For closed surfaces whose fronts look into the free space, counter-clockwise: a sample that
    /// begins inside a solid moves along its line until it has left the solid, and no segment lies
    /// in one. Of meshes that are not so, much is left out.
    bool skip_solids = false;
};

/// Free segments through points uniform in the region, with directions uniform on the sphere, that
/// end at a triangle at least on one side; in the order of the samples (GameTools 2007, the
/// sampling of view cells). Sample i is a function of seed and i alone. Precondition: the tree was
/// built over or refitted to this mesh. Throws Error as check(region).
std::vector<FreeSegment> sample_free_segments(const bvh::WideTree& tree,
                                              const geometry::MeshView& mesh,
                                              const Region& region,
                                              const SegmentSampling& sampling = {},
                                              Executor& executor = Executor::serial());

}  // namespace earshot::visibility
