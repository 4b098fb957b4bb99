// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

struct ReinsertionOptions {
    int max_iterations = 6;           ///< batches, 0 or more
    double batch_size_ratio = 0.005;  ///< candidates of a batch over nodes of the tree, 0 to 1
    /// Of a tree of groups (see groups_of_nodes()): subtrees stay within their group, and groups
    /// move as a whole. Empty: the tree has no groups.
    std::span<const std::uint32_t> group_of_node{};
};

/// What the optimisation did to a tree.
struct ReinsertionReport {
    double sah_cost_before = 0.0;  ///< sah_cost() with a traversal cost of 1
    double sah_cost_after = 0.0;
    std::size_t reinsertions = 0;  ///< subtrees that were moved
};

/// Lowers the SAH cost of a tree: subtrees are removed and inserted again where they enlarge the
/// boxes least (insertion-based optimisation, Bittner, Hapala and Havran 2013), in batches that
/// search in parallel (Meister and Bittner 2018). It restores a tree that refits have degraded as
/// well as it improves a new one. Answers do not change. The result depends on the tree and the
/// options alone, never costs more than the tree given (which then stays as it is) and is in
/// depth-first order. Throws Error if an option is out of range.
ReinsertionReport optimise_by_reinsertion(Tree& tree,
                                          const ReinsertionOptions& options = {},
                                          Executor& executor = Executor::serial());

}  // namespace earshot::bvh
