// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/aabb.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::collision {

/// Two triangles, first < second, and the tests of boxes that it took to find a list of them.
using IndexPair = std::pair<std::uint32_t, std::uint32_t>;

/// The parts of a search that are worked on independently, in an order that depends on the tree
/// alone.
class PairSearch {
public:
    /// `boxes`: of the tree's primitives, in the order of their numbers. Both must outlive it.
    PairSearch(const bvh::Tree& tree, std::span<const geometry::Aabb> boxes);

    std::size_t parts() const noexcept { return parts_.size(); }

    /// Gives `use` every pair of primitives of a part whose boxes meet, each pair of the whole
    /// search once. Returns how many boxes were tested.
    template <class Use>
    std::uint64_t for_each_pair(std::size_t part, const Use& use) const {
        std::uint64_t tests = 0;
        std::vector<IndexPair> open{parts_[part]};
        while (!open.empty()) {
            const auto [a, b] = open.back();
            open.pop_back();
            if (a == b && tree_.nodes()[a].is_leaf()) {
                tests += pairs_within(a, use);
            } else if (tree_.nodes()[a].is_leaf() && tree_.nodes()[b].is_leaf()) {
                tests += pairs_between(a, b, use);
            } else {
                tests += divide(a, b, open);
            }
        }
        return tests;
    }

private:
    /// Adds the pairs of children whose boxes meet.
    std::uint64_t divide(std::uint32_t a, std::uint32_t b, std::vector<IndexPair>& open) const;

    static bool meet(const geometry::Aabb& a, const geometry::Aabb& b) noexcept {
        return (a.lower[0] <= b.upper[0]) & (b.lower[0] <= a.upper[0]) &
               (a.lower[1] <= b.upper[1]) & (b.lower[1] <= a.upper[1]) &
               (a.lower[2] <= b.upper[2]) & (b.lower[2] <= a.upper[2]);
    }

    template <class Use>
    void use_pair(std::uint32_t a, std::uint32_t b, const Use& use) const {
        if (meet(boxes_[a], boxes_[b])) {
            use(std::min(a, b), std::max(a, b));
        }
    }

    template <class Use>
    std::uint64_t pairs_within(std::uint32_t leaf, const Use& use) const {
        const bvh::Node& node = tree_.nodes()[leaf];
        for (std::uint32_t i = 0; i < node.count; ++i) {
            for (std::uint32_t k = i + 1; k < node.count; ++k) {
                use_pair(
                    tree_.primitives()[node.first + i], tree_.primitives()[node.first + k], use);
            }
        }
        return node.count * (node.count - 1) / 2;
    }

    template <class Use>
    std::uint64_t pairs_between(std::uint32_t a, std::uint32_t b, const Use& use) const {
        const bvh::Node& left = tree_.nodes()[a];
        const bvh::Node& right = tree_.nodes()[b];
        for (std::uint32_t i = 0; i < left.count; ++i) {
            const std::uint32_t first = tree_.primitives()[left.first + i];
            for (std::uint32_t k = 0; k < right.count; ++k) {
                use_pair(first, tree_.primitives()[right.first + k], use);
            }
        }
        return left.count * right.count;
    }

    const bvh::Tree& tree_;
    std::span<const geometry::Aabb> boxes_;
    std::vector<IndexPair> parts_;  // of nodes
};

}  // namespace earshot::collision
