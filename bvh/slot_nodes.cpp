// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/slot_nodes.h"

#include <limits>

namespace earshot::bvh {
namespace {

/// How many primitives lie below every node.
std::vector<std::uint32_t> primitive_counts(const Tree& tree) {
    const auto nodes = tree.nodes();
    std::vector<std::uint32_t> counts(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {
        const Node& node = nodes[i];
        counts[i] = node.is_leaf() ? node.count : counts[node.first] + counts[node.first + 1];
    }
    return counts;
}

std::vector<std::uint32_t> primitive_counts(const WideTree& wide) {
    const auto nodes = wide.nodes();
    std::vector<std::uint32_t> counts(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {
        for (const std::uint32_t child : nodes[i].child) {
            if (child != kNoChild) {
                counts[i] +=
                    is_leaf(child) ? static_cast<std::uint32_t>(leaf_count(child)) : counts[child];
            }
        }
    }
    return counts;
}

/// The node below `root`, or it itself, that holds `count` primitives from the `begin`-th of the
/// subtree on; the leaf around them if they are a part of it.
std::uint32_t node_with(const Tree& tree,
                        const std::vector<std::uint32_t>& counts,
                        std::uint32_t root,
                        std::uint32_t begin,
                        std::uint32_t count) {
    std::uint32_t node = root;
    while (!(begin == 0 && counts[node] == count) && !tree.nodes()[node].is_leaf()) {
        const std::uint32_t left = tree.nodes()[node].first;
        node = begin < counts[left] ? left : left + 1;
        begin -= node == left ? 0 : counts[left];
    }
    return node;
}

}  // namespace

// The slots of a wide node hold subtrees of the binary tree from the left to the right, so that the
// counts of their primitives tell which.
std::vector<std::uint32_t> slot_nodes(const Tree& tree, const WideTree& wide) {
    std::vector<std::uint32_t> result;
    if (tree.nodes().empty()) {
        return result;
    }
    const std::vector<std::uint32_t> counts = primitive_counts(tree);
    const std::vector<std::uint32_t> wide_counts = primitive_counts(wide);
    struct StackEntry {
        std::uint32_t wide_node, node;
    };
    std::vector<StackEntry> stack = {{0, 0}};
    while (!stack.empty()) {
        const StackEntry top = stack.back();
        stack.pop_back();
        std::uint32_t begin = 0;
        for (const std::uint32_t child : wide.nodes()[top.wide_node].child) {
            if (child == kNoChild) {
                continue;
            }
            const auto count =
                is_leaf(child) ? static_cast<std::uint32_t>(leaf_count(child)) : wide_counts[child];
            result.push_back(node_with(tree, counts, top.node, begin, count));
            begin += count;
            if (!is_leaf(child)) {
                stack.push_back({child, result.back()});
            }
        }
    }
    return result;
}

double sah_cost(const Tree& tree, const std::vector<std::uint32_t>& slot_nodes) noexcept {
    const double root_area = tree.nodes().front().box.half_area();
    if (!(root_area > 0.0)) {
        return std::numeric_limits<double>::infinity();
    }
    double area = 0.0;
    for (const std::uint32_t node : slot_nodes) {
        area += tree.nodes()[node].box.half_area();
    }
    return 1.0 + area / root_area;
}

}  // namespace earshot::bvh
