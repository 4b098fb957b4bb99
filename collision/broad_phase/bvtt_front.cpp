// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/bvtt_front.h"

#include <algorithm>

namespace earshot::collision {

namespace {

BvttNode ordered(std::uint32_t a, std::uint32_t b) noexcept {
    return {std::min(a, b), std::max(a, b)};
}

/// Whether two nodes of the BVH have one parent: the left of two siblings has an odd index.
bool are_siblings(std::uint32_t a, std::uint32_t b) noexcept {
    return a != b && (a - 1) / 2 == (b - 1) / 2 && a != 0 && b != 0;
}

}  // namespace

BvttChildren expand(std::span<const bvh::Node> nodes, const BvttNode& node) noexcept {
    const auto [a, b] = node;
    const bvh::Node& left = nodes[a];
    const bvh::Node& right = nodes[b];
    if (a == b) {
        return {{BvttNode{left.first, left.first},
                 BvttNode{left.first + 1, left.first + 1},
                 BvttNode{left.first, left.first + 1}},
                3};
    }
    // The larger node is expanded, so that both boxes stay of similar size.
    const bool expand_left =
        right.is_leaf() || (!left.is_leaf() && left.box.half_area() >= right.box.half_area());
    const std::uint32_t child = expand_left ? left.first : right.first;
    const std::uint32_t other = expand_left ? b : a;
    return {{ordered(child, other), ordered(child + 1, other), {}}, 2};
}

BvttParent parent_of_last(std::span<const FrontEntry> entries,
                          std::span<const std::uint32_t> parents) noexcept {
    const std::size_t count = entries.size();
    if (count < 2 || !entries[count - 1].is_culled() || !entries[count - 2].is_culled()) {
        return {};
    }
    const BvttNode a = entries[count - 1].node();
    const BvttNode b = entries[count - 2].node();
    const bool any_newly =
        entries[count - 1].is_newly_culled() || entries[count - 2].is_newly_culled();
    // Halves of a pair that were expanded on either side.
    if (!a.is_self() && !b.is_self()) {
        if (a.second == b.second && are_siblings(a.first, b.first)) {
            return {ordered(parents[a.first], a.second), 2, any_newly};
        }
        if (a.first == b.first && are_siblings(a.second, b.second)) {
            return {ordered(a.first, parents[a.second]), 2, any_newly};
        }
        return {};
    }
    // A node against itself: its children against themselves, and against each other.
    if (count < 3 || !entries[count - 3].is_culled()) {
        return {};
    }
    const BvttNode c = entries[count - 3].node();
    std::array<BvttNode, 3> three{a, b, c};
    std::sort(three.begin(), three.end(), [](const BvttNode& x, const BvttNode& y) {
        return x.first != y.first ? x.first < y.first : x.second < y.second;
    });
    const std::uint32_t left = three[0].first;
    const std::uint32_t right = three[2].first;
    const bool are_children = are_siblings(left, right) && three[0] == BvttNode{left, left} &&
                              three[1] == BvttNode{left, right} &&
                              three[2] == BvttNode{right, right};
    return are_children ? BvttParent{{parents[left], parents[left]},
                                     3,
                                     any_newly || entries[count - 3].is_newly_culled()}
                        : BvttParent{};
}

std::size_t BvttFront::size() const noexcept {
    std::size_t entries = 0;
    for (const auto& subfront : subfronts_) {
        entries += subfront.size();
    }
    return entries;
}

void BvttFront::find_parents(std::span<const bvh::Node> nodes) {
    parents_.assign(nodes.size(), 0);
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) {
            parents_[nodes[i].first] = parents_[nodes[i].first + 1] = i;
        }
    }
}

void BvttFront::split_large_subfronts() {
    constexpr std::size_t kMinSize = 512;
    constexpr std::size_t kMinParts = 64;  // of a front of many entries
    const std::size_t limit = std::max(kMinSize, size() / kMinParts);
    for (std::size_t i = 0; i < subfronts_.size(); ++i) {
        while (subfronts_[i].size() > limit) {
            const auto middle =
                subfronts_[i].begin() + static_cast<std::ptrdiff_t>(subfronts_[i].size() / 2);
            std::vector<FrontEntry> rest(middle, subfronts_[i].end());
            subfronts_[i].erase(middle, subfronts_[i].end());
            subfronts_.push_back(std::move(rest));
        }
    }
}

}  // namespace earshot::collision
