// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/swept_pairs.h"

namespace earshot::collision {

PairSearch::PairSearch(const bvh::Tree& tree, std::span<const geometry::Aabb> boxes)
    : tree_(tree), boxes_(boxes) {
    if (tree.nodes().empty()) {
        return;
    }
    // Far more than there are threads, so that none waits for the last.
    constexpr std::size_t kParts = 1024;
    parts_.emplace_back(0, 0);
    for (bool grows = true; grows && parts_.size() < kParts;) {
        grows = false;
        std::vector<IndexPair> next;
        for (const auto& [a, b] : parts_) {
            if (tree.nodes()[a].is_leaf() && tree.nodes()[b].is_leaf()) {
                next.emplace_back(a, b);
            } else {
                divide(a, b, next);
                grows = true;
            }
        }
        parts_ = std::move(next);
    }
}

std::uint64_t PairSearch::divide(std::uint32_t a,
                                 std::uint32_t b,
                                 std::vector<IndexPair>& open) const {
    const bvh::Node& left = tree_.nodes()[a];
    const bvh::Node& right = tree_.nodes()[b];
    const auto add = [&](std::uint32_t x, std::uint32_t y) {
        if (meet(tree_.nodes()[x].box, tree_.nodes()[y].box)) {
            open.emplace_back(x, y);
        }
    };
    if (a == b) {
        open.emplace_back(left.first, left.first);
        open.emplace_back(left.first + 1, left.first + 1);
        add(left.first, left.first + 1);
        return 1;
    }
    // The larger is divided, so that boxes stay of one size.
    const bool divides_left =
        right.is_leaf() || (!left.is_leaf() && left.box.half_area() >= right.box.half_area());
    const std::uint32_t child = divides_left ? left.first : right.first;
    const std::uint32_t other = divides_left ? b : a;
    add(child, other);
    add(child + 1, other);
    return 2;
}

}  // namespace earshot::collision
