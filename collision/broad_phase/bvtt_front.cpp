// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/bvtt_front.h"

#include <utility>

namespace earshot::collision {

void PairFront::begin_at_root(const bvh::Tree& tree,
                              const std::function<bool(const NodePair&)>& is_settled) {
    // Far more parts than there are threads, so that none waits for the last.
    constexpr std::size_t kParts = 1024;
    age_ = 0;
    parts_.clear();
    if (tree.nodes().empty()) {
        return;
    }
    std::vector<NodePair> settled;
    std::vector<NodePair> pairs{{0, 0}};
    for (bool grows = true; grows && pairs.size() < kParts;) {
        grows = false;
        std::vector<NodePair> next;
        for (const NodePair& pair : pairs) {
            if (tree.nodes()[pair.first].is_leaf() && tree.nodes()[pair.second].is_leaf()) {
                next.push_back(pair);
            } else if (is_settled(pair)) {
                settled.push_back(pair);
            } else {
                divide(tree, pair, next);
                grows = true;
            }
        }
        pairs = std::move(next);
    }
    for (const NodePair& pair : pairs) {
        parts_.push_back({pair});
    }
    parts_.push_back(std::move(settled));
}

void divide(const bvh::Tree& tree, NodePair pair, std::vector<NodePair>& into) {
    const auto [a, b] = pair;
    const bvh::Node& left = tree.nodes()[a];
    const bvh::Node& right = tree.nodes()[b];
    if (a == b) {
        into.emplace_back(left.first, left.first);
        into.emplace_back(left.first + 1, left.first + 1);
        into.emplace_back(left.first, left.first + 1);
        return;
    }
    // The larger is divided, so that boxes stay of one size.
    const bool divides_left =
        right.is_leaf() || (!left.is_leaf() && left.box.half_area() >= right.box.half_area());
    const std::uint32_t child = divides_left ? left.first : right.first;
    const std::uint32_t other = divides_left ? b : a;
    into.emplace_back(child, other);
    into.emplace_back(child + 1, other);
}

}  // namespace earshot::collision
