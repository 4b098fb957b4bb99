// SPDX-License-Identifier: MIT
#include "earshot/bvh/reinsertion.h"

#include "earshot/base/error.h"
#include "earshot/bvh/internal/reinsertion_optimiser.h"
#include "earshot/bvh/quality.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::bvh {
namespace {

void validate(const ReinsertionOptions& options) {
    if (options.max_iterations < 0) {
        throw Error("reinsertion", "cannot make a negative number of iterations");
    }
    if (!(options.batch_size_ratio >= 0.0 && options.batch_size_ratio <= 1.0)) {
        throw Error("reinsertion", "the batch size must be 0 to 1 of the nodes");
    }
}

/// The tree of nodes in depth-first order, its primitives brought into the order of the leaves.
Tree with_primitives_in_leaf_order(std::vector<Node> nodes,
                                   std::span<const std::uint32_t> primitives) {
    std::vector<std::uint32_t> ordered;
    ordered.reserve(primitives.size());
    for (Node& node : nodes) {
        if (node.is_leaf()) {
            const auto first = static_cast<std::uint32_t>(ordered.size());
            const auto run = primitives.subspan(node.first, node.count);
            ordered.insert(ordered.end(), run.begin(), run.end());
            node.first = first;
        }
    }
    return Tree::from_nodes(std::move(nodes), std::move(ordered));
}

}  // namespace

ReinsertionReport optimise_by_reinsertion(Tree& tree,
                                          const ReinsertionOptions& options,
                                          Executor& executor) {
    validate(options);
    ReinsertionReport report;
    report.sah_cost_before = report.sah_cost_after = sah_cost(tree);
    ReinsertionOptimiser optimiser(tree.nodes(), options.group_of_node);
    const auto batch_size = static_cast<std::size_t>(
        std::max(1.0, options.batch_size_ratio * static_cast<double>(tree.nodes().size())));
    std::size_t reinsertions = 0;
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
        const auto in_batch = optimiser.reinsert_batch(batch_size, executor);
        if (!in_batch) {
            break;
        }
        reinsertions += *in_batch;
    }
    optimiser.restore_best();
    if (reinsertions == 0) {
        return report;
    }
    // No nodes: the optimised tree is too deep for the stacks of the queries. Groups may lie as
    // deep again below their top-level tree.
    const std::size_t max_depth = options.group_of_node.empty() ? kMaxDepth : 2 * kMaxDepth;
    std::vector<Node> nodes = optimiser.depth_first_nodes(max_depth);
    if (nodes.empty()) {
        return report;
    }
    Tree optimised = with_primitives_in_leaf_order(std::move(nodes), tree.primitives());
    const double cost = sah_cost(optimised);
    if (cost < report.sah_cost_before) {
        tree = std::move(optimised);
        report.sah_cost_after = cost;
        report.reinsertions = reinsertions;
    }
    return report;
}

}  // namespace earshot::bvh
