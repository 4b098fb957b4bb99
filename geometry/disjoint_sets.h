// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace earshot::geometry {

/// Disjoint sets of the numbers 0 ... count - 1: union-find with path halving (Tarjan and van
/// Leeuwen 1984). The least number of a set stands for it, whatever the order of the unions.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count = 0) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }

    /// Appends a number that is a set of its own.
    void add() { parent_.push_back(static_cast<std::uint32_t>(parent_.size())); }

    /// The number that stands for the set of `i`. Precondition: i < count.
    std::uint32_t find(std::uint32_t i) noexcept {
        while (parent_[i] != i) {
            i = parent_[i] = parent_[parent_[i]];
        }
        return i;
    }

    /// Makes the sets of both numbers one. False if they were one before.
    bool unite(std::uint32_t a, std::uint32_t b) noexcept {
        const std::uint32_t root_a = find(a);
        const std::uint32_t root_b = find(b);
        parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
        return root_a != root_b;
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace earshot::geometry
