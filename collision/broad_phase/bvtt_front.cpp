// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/bvtt_front.h"

#include <utility>

namespace earshot::collision {

void BvttFront::restart_at_root(const bvh::Tree& tree,
                                const std::function<bool(const BvttNode&)>& is_culled) {
    // There are far more sub-fronts than threads, so that the load is balanced.
    constexpr std::size_t kMinSubfronts = 1024;
    age_ = 0;
    subfronts_.clear();
    if (tree.nodes().empty()) {
        return;
    }
    std::vector<BvttNode> culled;
    std::vector<BvttNode> level{{0, 0}};
    for (bool has_inner = true; has_inner && level.size() < kMinSubfronts;) {
        has_inner = false;
        std::vector<BvttNode> next;
        for (const BvttNode& node : level) {
            if (tree.nodes()[node.first].is_leaf() && tree.nodes()[node.second].is_leaf()) {
                next.push_back(node);
            } else if (is_culled(node)) {
                culled.push_back(node);
            } else {
                expand(tree, node, next);
                has_inner = true;
            }
        }
        level = std::move(next);
    }
    for (const BvttNode& node : level) {
        subfronts_.push_back({node});
    }
    subfronts_.push_back(std::move(culled));
}

void expand(const bvh::Tree& tree, BvttNode node, std::vector<BvttNode>& children) {
    const auto [a, b] = node;
    const bvh::Node& left = tree.nodes()[a];
    const bvh::Node& right = tree.nodes()[b];
    if (a == b) {
        children.emplace_back(left.first, left.first);
        children.emplace_back(left.first + 1, left.first + 1);
        children.emplace_back(left.first, left.first + 1);
        return;
    }
    // The larger node is expanded, so that both boxes stay of similar size.
    const bool expand_left =
        right.is_leaf() || (!left.is_leaf() && left.box.half_area() >= right.box.half_area());
    const std::uint32_t child = expand_left ? left.first : right.first;
    const std::uint32_t other = expand_left ? b : a;
    children.emplace_back(child, other);
    children.emplace_back(child + 1, other);
}

}  // namespace earshot::collision
