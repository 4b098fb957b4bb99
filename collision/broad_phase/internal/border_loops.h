// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/internal/moving_scene.h"

#include <vector>

namespace earshot::collision {

/// Borders of the patches below the nodes of a tree.
struct BorderLoops {
    std::vector<SlotRange> of_node;  ///< within `vertices`; empty if the border is not one loop
    std::vector<geometry::VertexId> vertices;
};

/// An edge is on the border unless another triangle of the patch has it the other way round.
/// Patches of fewer than `least` triangles, and of several meshes, get no loop.
BorderLoops border_loops(const MovingScene& scene, const SweptForest& forest, std::uint32_t least);

}  // namespace earshot::collision
