// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::bvh {

struct OptimiseOptions {
    int passes = 6;        ///< 0 or more
    double share = 0.005;  ///< of the nodes, largest first, that a pass tries to place better
};

/// What optimising has done.
struct OptimiseReport {
    double cost_before = 0.0;  ///< sah_cost() with a traversal cost of 1
    double cost_after = 0.0;
    std::size_t moves = 0;  ///< subtrees that found a better place
};

/// Lowers the SAH cost of a tree by taking subtrees out and inserting them where they enlarge the
/// boxes least: insertion-based optimisation (Bittner, Hapala and Havran 2013) in batches, with the
/// search of Meister and Bittner 2018. What a tree costs more than one built afresh because its
/// boxes have drifted apart is won back the same way. Answers do not change. The result depends on
/// the tree and the options alone, never costs more than what was given (else it is left as it was)
/// and is in depth-first order. Throws Error if an option is out of range.
OptimiseReport optimise(Tree& tree,
                        const OptimiseOptions& options = {},
                        Executor& executor = Executor::serial());

}  // namespace earshot::bvh
