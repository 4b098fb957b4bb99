// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace earshot::test {

inline bool contains(const geometry::Aabb& outer, const geometry::Aabb& inner) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (inner.lower[k] < outer.lower[k] || inner.upper[k] > outer.upper[k]) {
            return false;
        }
    }
    return true;
}

/// What is wrong with a tree over `boxes`; empty if nothing is: every primitive stands in one leaf,
/// children lie in their parents and leaves hold their boxes tightly, nodes are in depth-first
/// order, no leaf is too deep or too large.
inline std::string fault_of(const bvh::Tree& tree,
                            const std::vector<geometry::Aabb>& boxes,
                            std::size_t max_leaf_size) {
    struct Visit {
        std::uint32_t node;
        std::size_t depth;
    };
    std::vector<int> seen(boxes.size(), 0);
    std::vector<Visit> open;
    std::uint32_t next = 1;  // where the next children must stand
    if (!tree.nodes().empty()) {
        open.push_back({0, 0});
    }
    while (!open.empty()) {
        const Visit visit = open.back();
        open.pop_back();
        const bvh::Node& node = tree.nodes()[visit.node];
        if (visit.depth > bvh::kMaxDepth) {
            return "too deep";
        }
        geometry::Aabb box;
        if (node.is_leaf()) {
            if (node.count > max_leaf_size) {
                return "leaf too large";
            }
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                ++seen.at(tree.primitives()[i]);
                box.include(boxes[tree.primitives()[i]]);
            }
        } else {
            if (node.first != next) {
                return "not in depth-first order";
            }
            next += 2;
            box = tree.nodes()[node.first].box;
            box.include(tree.nodes()[node.first + 1].box);
            open.push_back({node.first + 1, visit.depth + 1});
            open.push_back({node.first, visit.depth + 1});
        }
        if (!(box == node.box)) {
            return "box of node " + std::to_string(visit.node) + " does not fit its contents";
        }
    }
    if (std::any_of(seen.begin(), seen.end(), [](int count) { return count != 1; })) {
        return "a primitive is missing or stands twice";
    }
    return next == tree.nodes().size() || boxes.empty() ? "" : "unreachable nodes";
}

}  // namespace earshot::test
