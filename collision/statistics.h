// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/bvh/update_statistics.h"

#include <cstdint>

namespace earshot::collision {

/// The work of the last search, the same for any executor.
struct WorldStatistics {
    std::uint64_t box_tests = 0;       ///< of pairs of boxes, and of normal cones
    std::uint64_t triangle_pairs = 0;  ///< whose boxes, swept during a step, overlap
    /// Of a vertex and a face or of two edges; at an instant of two triangles, in double precision.
    std::uint64_t elementary_tests = 0;

    /// Nodes of the BVTTs at which the traversals stopped, and at which the next ones begin.
    std::uint64_t front_nodes = 0;
    bvh::UpdateStatistics updates{};  ///< of trees, by which they followed the meshes

    WorldStatistics& operator+=(const WorldStatistics& other) noexcept;
};

}  // namespace earshot::collision
