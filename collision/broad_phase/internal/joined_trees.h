// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::collision {

/// One tree whose subtrees are others. It may be deeper than bvh::kMaxDepth.
struct JoinedTrees {
    bvh::Tree tree;
    /// Which tree each node comes from; the largest number for nodes above them.
    std::vector<std::uint32_t> tree_of_node;
};

/// Primitives are numbered on from tree to tree, leaves stand in depth-first order. Trees without
/// nodes are left out.
JoinedTrees join(std::span<const bvh::Tree> trees);

}  // namespace earshot::collision
