// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/internal/touch_pages.h"
#include "earshot/bvh/tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// A node of the upper levels of a tree, below which subtrees are built by a task each.
struct TopNode {
    geometry::Aabb box{};
    std::uint32_t left = 0;  ///< index of the left child, which the right one follows; 0: the root
                             ///< of a task's subtree
    std::uint32_t task = 0;
};

/// Joins the upper levels of a tree, top[0] being the root, and the subtrees of the tasks into one
/// array of nodes in depth-first order. Task t built counts[t] nodes in depth-first order, the root
/// first, and node_of(t, i) is the i-th, whose child index counts from that root.
template <class NodeOf>
class TreeAssembly {
public:
    TreeAssembly(std::span<const TopNode> top,
                 std::span<const std::uint32_t> counts,
                 const NodeOf& node_of,
                 Executor& executor)
        : top_(top), counts_(counts), node_of_(node_of), shifts_(counts.size()) {
        std::size_t all = 1;
        for (const TopNode& node : top) {
            all += node.left != 0 ? 2 : counts[node.task] - 1;
        }
        nodes_ = vector_on_touched_pages<Node>(all, executor);
        emit(0, 0);
    }

    /// `grain`: tasks whose nodes are copied together.
    std::vector<Node> nodes(Executor& executor, std::size_t grain = 1) && {
        executor.for_each(counts_.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (auto task = static_cast<std::uint32_t>(begin); task < end; ++task) {
                for (std::uint32_t i = 1; i < counts_[task]; ++i) {
                    nodes_[shifts_[task] + i] = shifted(task, i);
                }
            }
        });
        return std::move(nodes_);
    }

private:
    Node shifted(std::uint32_t task, std::uint32_t index) const {
        Node node = node_of_(task, index);
        node.first += node.is_leaf() ? 0 : shifts_[task];
        return node;
    }

    void emit(std::uint32_t source, std::uint32_t target) {
        const TopNode& node = top_[source];
        if (node.left == 0) {
            // A task's nodes follow its root, which goes to the slot beside its sibling.
            shifts_[node.task] = next_ - 1;
            nodes_[target] = shifted(node.task, 0);
            next_ += counts_[node.task] - 1;
            return;
        }
        const std::uint32_t children = next_;
        next_ += 2;
        nodes_[target].box = node.box;
        nodes_[target].first = children;
        emit(node.left, children);
        emit(node.left + 1, children + 1);
    }

    std::span<const TopNode> top_;
    std::span<const std::uint32_t> counts_;
    const NodeOf& node_of_;
    std::vector<std::uint32_t> shifts_;
    std::vector<Node> nodes_;
    std::uint32_t next_ = 1;
};

}  // namespace earshot::bvh
