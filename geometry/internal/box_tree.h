// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// An axis-aligned box in double precision.
struct Box {
    Vec3 lower{0.0}, upper{0.0};

    bool overlaps(const Box& other) const noexcept {
        for (int k = 0; k < 3; ++k) {
            if (lower[k] > other.upper[k] || upper[k] < other.lower[k]) {
                return false;
            }
        }
        return true;
    }
};

/// A balanced tree over boxes, split at the median of their centres, for the few box queries that
/// `geometry` makes; the hierarchies of scenes are in `bvh`.
class BoxTree {
public:
    /// O(n log n).
    explicit BoxTree(std::span<const Box> boxes);

    /// The boxes that touch the query, ascending.
    std::vector<std::uint32_t> overlapping(const Box& query) const;
    /// Whether a box touches the query.
    bool any_overlapping(const Box& query) const;

private:
    struct Node {
        Box box;
        std::uint32_t begin = 0, end = 0;  // of order_
        std::uint32_t right = 0;           // second child; the first follows its parent; 0: a leaf
    };

    void build(std::span<const Box> boxes, std::uint32_t begin, std::uint32_t end);
    /// Calls visit(box) for boxes that touch the query until it returns false.
    template <typename Visit>
    void visit_overlapping(const Box& query, const Visit& visit) const;

    std::vector<Box> boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace earshot::geometry
