// SPDX-License-Identifier: MIT
#include "earshot/bvh/optimise.h"

#include "earshot/base/error.h"
#include "earshot/bvh/internal/reinserter.h"
#include "earshot/bvh/quality.h"

#include <algorithm>

namespace earshot::bvh {
namespace {

/// The leaves' runs of primitives in the order of the nodes.
Tree in_order(std::vector<Node> nodes, std::span<const std::uint32_t> primitives) {
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

OptimiseReport optimise(Tree& tree, const OptimiseOptions& options, Executor& executor) {
    if (options.passes < 0) {
        throw Error("optimisation", "cannot make a negative number of passes");
    }
    if (!(options.share >= 0.0 && options.share <= 1.0)) {
        throw Error("optimisation", "the share of nodes in a pass must be 0 to 1");
    }
    OptimiseReport report;
    report.cost_before = report.cost_after = sah_cost(tree);
    Reinserter reinserter(tree.nodes());
    const auto count = static_cast<std::size_t>(
        std::max(1.0, options.share * static_cast<double>(tree.nodes().size())));
    for (int pass = 0; pass < options.passes; ++pass) {
        const std::size_t moves = reinserter.improve(count, executor);
        report.moves += moves;
        if (moves == 0) {
            break;
        }
    }
    if (report.moves == 0) {
        return report;
    }
    std::vector<Node> nodes = reinserter.ordered();
    if (nodes.empty()) {
        report.moves = 0;
        return report;
    }
    Tree optimised = in_order(std::move(nodes), tree.primitives());
    const double cost = sah_cost(optimised);
    if (cost < report.cost_before) {
        tree = std::move(optimised);
        report.cost_after = cost;
    } else {
        report.moves = 0;
    }
    return report;
}

}  // namespace earshot::bvh
