// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/bvh/update_policy.h"

#include <cstdint>

namespace earshot::collision {

/// The work of the last search, the same for any executor.
struct WorldStatistics {
    std::uint64_t box_tests = 0;       ///< of pairs of boxes, and of normal cones
    std::uint64_t triangle_pairs = 0;  ///< whose boxes, swept during a step, overlap
    /// Of a vertex and a face or of two edges; at an instant of two triangles, in double precision.
    std::uint64_t elementary_tests = 0;

    // What following the meshes did to trees that were there before.
    std::uint64_t refits = 0, repairs = 0, rebuilds = 0;

    WorldStatistics& operator+=(const WorldStatistics& other) noexcept;

    /// Counts an update of a tree.
    void count(bvh::UpdateAction action) noexcept;
};

}  // namespace earshot::collision
