// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/bvh/wide_tree.h"

#include <cstddef>

namespace earshot::bvh {

/// Size and SAH cost of a hierarchy, for reports and for deciding when to rebuild.
struct Quality {
    std::size_t nodes = 0;
    std::size_t leaves = 0;
    std::size_t depth = 0;  ///< of the deepest leaf; the root has depth 0
    double sah_cost = 0.0;  ///< see sah_cost()
    std::size_t bytes = 0;  ///< of nodes and primitive indices
};

Quality quality(const Tree& tree, double traversal_cost = 1.0);

/// Expected work of a random ray that hits the root's box, in primitive tests: the surface area
/// heuristic (MacDonald and Booth 1990; Wald 2007, section 2). 0 for an empty tree; if
/// the root has no area, the work of visiting everything.
double sah_cost(const Tree& tree, double traversal_cost = 1.0) noexcept;

/// Expected node and leaf visits of a random ray that hits the tree's box: the surface area
/// heuristic with a cost of 1 for a wide node and 1 for a leaf. It grows as refits let boxes
/// overlap. Reads the nodes only, a twentieth of what a refit reads and writes; the same bits for
/// any executor. 0 for an empty tree; if the box has no area, the number of nodes.
double sah_cost(const WideTree& tree, Executor& executor = Executor::serial());

}  // namespace earshot::bvh
