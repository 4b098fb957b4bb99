// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// A tree under reconstruction: siblings stay side by side, but parents may come to stand behind
/// their children until ordered() puts the nodes into depth-first order again.
class Reinserter {
public:
    explicit Reinserter(std::span<const Node> nodes);

    /// A subtree and the node beside which it goes; `to` is 0 if it stays.
    struct Move {
        std::uint32_t from = 0, to = 0;
        double gain = 0.0;  ///< by how much the sum of areas shrinks
    };

    /// The best place for a subtree. Precondition: neither the root nor a child of it.
    Move best_move(std::uint32_t from) const;

    /// One batch: the `count` nodes whose places seem worst look for better ones, all in the same
    /// tree; the moves that gain most are made first, and those that touch what another has changed
    /// are dropped. Returns the number of moves.
    std::size_t improve(std::size_t count, Executor& executor);

    /// The nodes in depth-first order. Empty if a leaf lies deeper than kMaxDepth.
    std::vector<Node> ordered() const;

    /// The sum of inner nodes' half areas: the SAH cost but for a factor and the leaves, whose sum
    /// no move changes.
    double inner_area() const noexcept;

private:
    std::uint32_t sibling(std::uint32_t index) const noexcept {
        // The root is alone in its place, so that a pair begins at an odd index.
        return index % 2 == 1 ? index + 1 : index - 1;
    }
    double area(std::uint32_t index) const noexcept { return nodes_[index].box.half_area(); }
    std::vector<std::uint32_t> worst(std::size_t count, Executor& executor) const;
    bool make(const Move& move);
    void adopt(std::uint32_t index);
    void refit_from(std::uint32_t index);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> parents_;
    std::vector<std::uint8_t> is_touched_;
};

}  // namespace earshot::bvh
