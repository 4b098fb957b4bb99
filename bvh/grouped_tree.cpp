// SPDX-License-Identifier: MIT
#include "earshot/bvh/grouped_tree.h"

#include "earshot/base/assert.h"

#include <utility>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

// Larger groups are built one after another, each in parallel; smaller ones next to each other.
constexpr std::size_t kLargeGroup = 16384;

std::vector<Tree> build_groups(std::span<const Aabb> boxes,
                               std::span<const std::size_t> group_ends,
                               const BuildOptions& options,
                               Executor& executor) {
    std::vector<Tree> trees(group_ends.size());
    const auto boxes_of = [&](std::size_t group) {
        const std::size_t begin = group == 0 ? 0 : group_ends[group - 1];
        return boxes.subspan(begin, group_ends[group] - begin);
    };
    for (std::size_t group = 0; group < trees.size(); ++group) {
        if (boxes_of(group).size() >= kLargeGroup) {
            trees[group] = Tree::build(boxes_of(group), options, executor);
        }
    }
    executor.for_each(trees.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t group = begin; group < end; ++group) {
            if (boxes_of(group).size() < kLargeGroup) {
                trees[group] = Tree::build(boxes_of(group), options);
            }
        }
    });
    return trees;
}

/// Builds the top-level tree over the roots of trees and copies their nodes below its leaves:
/// depth-first, siblings side by side. Primitives are numbered on from tree to tree.
class Merger {
public:
    explicit Merger(std::span<const Tree> trees) : trees_(trees) {
        std::uint32_t primitives = 0;
        std::size_t below_roots = 0;
        std::vector<Aabb> boxes;
        for (std::uint32_t i = 0; i < trees.size(); ++i) {
            first_primitive_.push_back(primitives);
            primitives += static_cast<std::uint32_t>(trees[i].primitives().size());
            if (!trees[i].nodes().empty()) {
                boxes.push_back(trees[i].nodes()[0].box);
                tree_of_box_.push_back(i);
                below_roots += trees[i].nodes().size() - 1;
            }
        }
        if (boxes.empty()) {
            return;
        }
        top_ = Tree::build(boxes, {.max_leaf_size = 1});
        nodes_.resize(top_.nodes().size() + below_roots);
        primitives_.reserve(primitives);
        copy_top(0, 0);
    }

    Tree merged() && { return Tree::from_nodes(std::move(nodes_), std::move(primitives_)); }

private:
    void copy_top(std::uint32_t source, std::uint32_t target) {
        const Node& node = top_.nodes()[source];
        if (node.is_leaf()) {
            copy_tree(tree_of_box_[top_.primitives()[node.first]], target);
            return;
        }
        const std::uint32_t children = next_;
        next_ += 2;
        nodes_[target] = {.box = node.box, .first = children, .count = 0};
        copy_top(node.first, children);
        copy_top(node.first + 1, children + 1);
    }

    /// Copies a tree: its root to `target`, beside the root's sibling, the other nodes behind.
    void copy_tree(std::uint32_t tree, std::uint32_t target) {
        const std::span<const Node> nodes = trees_[tree].nodes();
        const std::uint32_t shift = next_ - 1;
        const auto first_of_tree = static_cast<std::uint32_t>(primitives_.size());
        for (std::uint32_t i = 0; i < nodes.size(); ++i) {
            const std::uint32_t to = i == 0 ? target : shift + i;
            nodes_[to] = nodes[i];
            nodes_[to].first += nodes[i].is_leaf() ? first_of_tree : shift;
        }
        for (const std::uint32_t primitive : trees_[tree].primitives()) {
            primitives_.push_back(first_primitive_[tree] + primitive);
        }
        next_ += static_cast<std::uint32_t>(nodes.size()) - 1;
    }

    std::span<const Tree> trees_;
    Tree top_;
    std::vector<std::uint32_t> tree_of_box_, first_primitive_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> primitives_;
    std::uint32_t next_ = 1;
};

}  // namespace

Tree build_grouped(std::span<const Aabb> boxes,
                   std::span<const std::size_t> group_ends,
                   const BuildOptions& options,
                   Executor& executor) {
    EARSHOT_ASSERT((group_ends.empty() ? 0 : group_ends.back()) == boxes.size());
    return Merger(build_groups(boxes, group_ends, options, executor)).merged();
}

std::vector<std::uint32_t> groups_of_nodes(const Tree& tree,
                                           std::span<const std::size_t> group_ends) {
    std::vector<std::uint32_t> groups;
    if (group_ends.empty()) {
        return groups;
    }
    std::vector<std::uint32_t> group_of_primitive;
    group_of_primitive.reserve(group_ends.back());
    for (std::uint32_t group = 0; group < group_ends.size(); ++group) {
        group_of_primitive.resize(group_ends[group], group);
    }
    groups.resize(tree.nodes().size());
    for (std::size_t i = groups.size(); i-- > 0;) {
        const Node& node = tree.nodes()[i];
        if (node.is_leaf()) {
            groups[i] = group_of_primitive[tree.primitives()[node.first]];
        } else {
            const std::uint32_t left = groups[node.first];
            groups[i] = left == groups[node.first + 1] ? left : kMixedGroups;
        }
    }
    return groups;
}

}  // namespace earshot::bvh
