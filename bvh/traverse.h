// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <array>
#include <concepts>
#include <cstdint>

namespace earshot::bvh {

/// Visits every primitive in a leaf whose box and all boxes above it pass `overlaps`, left before
/// right; `visit` returns false to stop. Does not allocate.
template <std::predicate<const Node&> Overlaps, std::predicate<std::uint32_t> Visit>
void traverse(const Tree& tree, Overlaps&& overlaps, Visit&& visit) {
    const auto nodes = tree.nodes();
    const auto primitives = tree.primitives();
    if (nodes.empty()) {
        return;
    }
    // Each inner node on the way down leaves its right child on the stack.
    std::array<std::uint32_t, kMaxDepth + 1> stack;
    std::size_t count = 0;
    std::uint32_t index = 0;
    while (true) {
        const Node& node = nodes[index];
        if (overlaps(node)) {
            if (!node.is_leaf()) {
                stack[count++] = node.first + 1;
                index = node.first;
                continue;
            }
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                if (!visit(primitives[i])) {
                    return;
                }
            }
        }
        if (count == 0) {
            return;
        }
        index = stack[--count];
    }
}

}  // namespace earshot::bvh
