// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Two nodes and the flow that may pass between them, from `a` to `b` and back.
struct FlowEdge {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    double forward = 0.0;
    double backward = 0.0;
};

struct MinCut {
    /// Per node: whether it is on the source's side, of all minimum cuts in that with the fewest
    /// nodes there.
    std::vector<bool> is_source_side;
    double flow = 0.0;  ///< capacity of the cut
};

/// The minimum cut between two nodes, by maximum flow (Boykov and Kolmogorov 2004). Capacities are
/// rounded to 2^-40 of their sum, on whole numbers, so that the result is exact and the same
/// everywhere. Preconditions: nodes below `node_count`, source and sink differ, capacities >= 0.
MinCut find_min_cut(std::size_t node_count,
                    std::span<const FlowEdge> edges,
                    std::uint32_t source,
                    std::uint32_t sink);

}  // namespace earshot::visibility
