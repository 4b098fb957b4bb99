// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/joined_trees.h"

#include <utility>

namespace earshot::collision {

namespace {

/// Lays nodes out in depth-first order, children side by side.
class Joiner {
public:
    explicit Joiner(std::span<const bvh::Tree> trees) : trees_(trees) {
        std::uint32_t primitives = 0;
        std::size_t below_roots = 0;
        std::vector<geometry::Aabb> boxes;
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
        top_ = bvh::Tree::build(boxes, {.leaf_size = 1});
        nodes_.resize(top_.nodes().size() + below_roots);
        tree_of_node_.resize(nodes_.size(), std::numeric_limits<std::uint32_t>::max());
        primitives_.reserve(primitives);
        place(0, 0);
    }

    JoinedTrees joined() && {
        return {bvh::Tree::from_nodes(std::move(nodes_), std::move(primitives_)),
                std::move(tree_of_node_)};
    }

private:
    void place(std::uint32_t source, std::uint32_t target) {
        const bvh::Node& node = top_.nodes()[source];
        if (node.is_leaf()) {
            place_tree(tree_of_box_[top_.primitives()[node.first]], target);
            return;
        }
        const std::uint32_t children = next_;
        next_ += 2;
        nodes_[target] = {.box = node.box, .first = children, .count = 0};
        place(node.first, children);
        place(node.first + 1, children + 1);
    }

    /// The nodes of a tree follow its root, which goes to the place beside its sibling.
    void place_tree(std::uint32_t tree, std::uint32_t target) {
        const std::span<const bvh::Node> nodes = trees_[tree].nodes();
        const std::uint32_t shift = next_ - 1;
        const auto slot = static_cast<std::uint32_t>(primitives_.size());
        for (std::uint32_t i = 0; i < nodes.size(); ++i) {
            const std::uint32_t to = i == 0 ? target : shift + i;
            nodes_[to] = nodes[i];
            nodes_[to].first += nodes[i].is_leaf() ? slot : shift;
            tree_of_node_[to] = tree;
        }
        for (const std::uint32_t primitive : trees_[tree].primitives()) {
            primitives_.push_back(first_primitive_[tree] + primitive);
        }
        next_ += static_cast<std::uint32_t>(nodes.size()) - 1;
    }

    std::span<const bvh::Tree> trees_;
    bvh::Tree top_;
    std::vector<std::uint32_t> tree_of_box_, first_primitive_;
    std::vector<bvh::Node> nodes_;
    std::vector<std::uint32_t> tree_of_node_, primitives_;
    std::uint32_t next_ = 1;
};

}  // namespace

JoinedTrees join(std::span<const bvh::Tree> trees) {
    return Joiner(trees).joined();
}

}  // namespace earshot::collision
