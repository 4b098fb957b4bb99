// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::bvh {

/// A node and its descendants, a contiguous range in depth-first order, which one task visits.
struct Subtree {
    std::size_t root = 0;
    std::size_t begin = 0, end = 0;  // descendants
};

/// Subtrees for a task each, and the nodes above them.
struct SubtreeDecomposition {
    std::vector<std::size_t> top;
    std::vector<Subtree> tasks;
};

/// Nodes of a subtree, at most.
inline constexpr std::size_t kSubtreeTaskSize = 4096;

inline SubtreeDecomposition decompose_into_subtrees(std::span<const Node> nodes) {
    SubtreeDecomposition result;
    std::vector<Subtree> stack = {{0, 1, nodes.size()}};
    while (!stack.empty()) {
        const Subtree subtree = stack.back();
        stack.pop_back();
        if (subtree.end - subtree.begin <= kSubtreeTaskSize) {
            result.tasks.push_back(subtree);
            continue;
        }
        result.top.push_back(subtree.root);
        const std::size_t left = nodes[subtree.root].first;
        const Node& right = nodes[left + 1];
        const std::size_t between = right.is_leaf() ? subtree.end : right.first;
        stack.push_back({left + 1, between, subtree.end});
        stack.push_back({left, left + 2, between});
    }
    return result;
}

/// Calls visit(index) for every node, children before parents; subtrees in parallel.
template <typename Visit>
void for_each_bottom_up(std::span<const Node> nodes, Executor& executor, Visit&& visit) {
    if (nodes.empty()) {
        return;
    }
    // Children stand behind their parents, so running backwards is bottom-up.
    const SubtreeDecomposition parts = decompose_into_subtrees(nodes);
    executor.for_each(parts.tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t task = begin; task < end; ++task) {
            const Subtree& subtree = parts.tasks[task];
            for (std::size_t i = subtree.end; i-- > subtree.begin;) {
                visit(i);
            }
            visit(subtree.root);
        }
    });
    for (std::size_t i = parts.top.size(); i-- > 0;) {
        visit(parts.top[i]);
    }
}

}  // namespace earshot::bvh
