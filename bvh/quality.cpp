// SPDX-License-Identifier: MIT
#include "earshot/bvh/quality.h"

#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace earshot::bvh {

double sah_cost(const Tree& tree, double traversal_cost) noexcept {
    if (tree.nodes().empty()) {
        return 0.0;
    }
    const double root_area = tree.nodes().front().box.half_area();
    double cost = 0.0;
    for (const Node& node : tree.nodes()) {
        const double probability = root_area > 0.0 ? node.box.half_area() / root_area : 1.0;
        cost += probability * (node.is_leaf() ? static_cast<double>(node.count) : traversal_cost);
    }
    return cost;
}

double sah_cost(const WideTree& tree, Executor& executor) {
    if (tree.nodes().empty()) {
        return 0.0;
    }
    // The root is visited for certain, a child with a probability of its area over the root's.
    // Chunks are summed apart and added in their order, so that threads do not show.
    constexpr std::size_t kGrain = 1024;
    std::vector<double> sums(chunk_count(tree.nodes().size(), kGrain), 0.0);
    executor.for_each(tree.nodes().size(), kGrain, [&](std::size_t begin, std::size_t end) {
        double sum = 0.0;
        for (std::size_t i = begin; i < end; ++i) {
            const WideNode& node = tree.nodes()[i];
            for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
                sum += node.child[slot] == kNoChild ? 0.0 : slot_box(node, slot).half_area();
            }
        }
        sums[begin / kGrain] = sum;
    });
    const double child_area = std::accumulate(sums.begin(), sums.end(), 0.0);
    const double root_area = tree.box().half_area();
    return root_area > 0.0 ? 1.0 + child_area / root_area
                           : static_cast<double>(tree.nodes().size());
}

Quality quality(const Tree& tree, double traversal_cost) {
    Quality result = {.nodes = tree.nodes().size(),
                      .sah_cost = sah_cost(tree, traversal_cost),
                      .bytes = tree.nodes().size_bytes() + tree.primitives().size_bytes()};
    struct StackEntry {
        std::uint32_t node;
        std::size_t depth;
    };
    std::vector<StackEntry> stack;
    if (!tree.nodes().empty()) {
        stack.push_back({0, 0});
    }
    while (!stack.empty()) {
        const auto [index, depth] = stack.back();
        stack.pop_back();
        const Node& node = tree.nodes()[index];
        if (node.is_leaf()) {
            ++result.leaves;
            result.depth = std::max(result.depth, depth);
        } else {
            stack.push_back({node.first, depth + 1});
            stack.push_back({node.first + 1, depth + 1});
        }
    }
    return result;
}

}  // namespace earshot::bvh
