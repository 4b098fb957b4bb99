// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/tree.h"

#include <vector>

namespace earshot::bvh {
namespace {

/// A node whose descendants, a contiguous run in depth-first order, are refitted by one task.
struct Subtree {
    std::size_t root = 0;
    std::size_t begin = 0, end = 0;  // descendants
};

/// The nodes above the tasks, and the tasks.
struct Cut {
    std::vector<std::size_t> top;
    std::vector<Subtree> tasks;
};

Cut cut(std::span<const Node> nodes) {
    constexpr std::size_t kTaskSize = 8192;
    Cut result;
    std::vector<Subtree> open = {{0, 1, nodes.size()}};
    while (!open.empty()) {
        const Subtree subtree = open.back();
        open.pop_back();
        if (subtree.end - subtree.begin <= kTaskSize) {
            result.tasks.push_back(subtree);
            continue;
        }
        result.top.push_back(subtree.root);
        const std::size_t left = nodes[subtree.root].first;
        const Node& right = nodes[left + 1];
        const std::size_t between = right.is_leaf() ? subtree.end : right.first;
        open.push_back({left + 1, between, subtree.end});
        open.push_back({left, left + 2, between});
    }
    return result;
}

}  // namespace

void Tree::refit(std::span<const geometry::Aabb> boxes, Executor& executor) {
    EARSHOT_ASSERT(boxes.size() == primitives_.size());
    if (nodes_.empty()) {
        return;
    }
    const auto refit_node = [&](std::size_t index) {
        Node& node = nodes_[index];
        geometry::Aabb box;
        if (node.is_leaf()) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                box.include(boxes[primitives_[i]]);
            }
        } else {
            box = nodes_[node.first].box;
            box.include(nodes_[node.first + 1].box);
        }
        node.box = box;
    };
    // Children stand behind their parents, so running backwards is bottom-up.
    const Cut parts = cut(nodes_);
    executor.for_each(parts.tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t task = begin; task < end; ++task) {
            const Subtree& subtree = parts.tasks[task];
            for (std::size_t i = subtree.end; i-- > subtree.begin;) {
                refit_node(i);
            }
            refit_node(subtree.root);
        }
    });
    for (std::size_t i = parts.top.size(); i-- > 0;) {
        refit_node(parts.top[i]);
    }
}

}  // namespace earshot::bvh
