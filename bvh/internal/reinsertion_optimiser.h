// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::bvh {

/// The nodes of a tree while subtrees are reinserted. Siblings stay adjacent in the array, but a
/// parent may be stored after its children until depth_first_nodes() restores the order.
class ReinsertionOptimiser {
public:
    /// `group_of_node`: see ReinsertionOptions.
    explicit ReinsertionOptimiser(std::span<const Node> nodes,
                                  std::span<const std::uint32_t> group_of_node = {});

    /// The subtree of `from` becomes the sibling of `to`. `to` is 0 if no reinsertion reduces the
    /// area.
    struct Reinsertion {
        std::uint32_t from = 0, to = 0;
        double area_diff = 0.0;  ///< by how much the sum of half areas shrinks
    };

    /// The reinsertion of a subtree that lowers the cost most. Precondition: the node is neither
    /// the root nor a child of the root or of the root of a group.
    Reinsertion find_reinsertion(std::uint32_t from) const;

    /// One batch: the `batch_size` children of the most inefficient nodes search for their best
    /// reinsertion in the unchanged tree; the reinsertions that gain most are made first, and those
    /// that conflict with an earlier one are dropped. Returns how many were made; nothing if no
    /// node was left to try, or if ten batches have lowered the cost no further.
    std::optional<std::size_t> reinsert_batch(std::size_t batch_size, Executor& executor);

    /// Undoes the batches after that with the least inner_area(), if any.
    void restore_best();

    /// The nodes in depth-first order. Empty if a leaf lies deeper than `max_depth`.
    std::vector<Node> depth_first_nodes(std::size_t max_depth = kMaxDepth) const;

    /// The sum of the half areas of inner nodes: the SAH cost but for a factor and the leaves,
    /// whose sum does not change.
    double inner_area() const noexcept;

private:
    std::uint32_t sibling(std::uint32_t index) const noexcept {
        // The root has no sibling, so a pair of siblings begins at an odd index.
        return index % 2 == 1 ? index + 1 : index - 1;
    }
    double area(std::uint32_t index) const noexcept { return nodes_[index].box.half_area(); }
    /// Whether a search may not pass the node: it is the root of a group.
    bool is_barrier(std::uint32_t index) const noexcept {
        return !is_group_root_.empty() && is_group_root_[index] != 0;
    }
    bool is_top(std::uint32_t index) const noexcept { return index == 0 || is_barrier(index); }
    double inefficiency(std::uint32_t index) const noexcept;
    std::vector<std::uint32_t> find_candidates(std::size_t count, Executor& executor) const;
    std::array<std::uint32_t, 6> get_conflicts(const Reinsertion& reinsertion) const noexcept;
    std::size_t make_reinsertions(std::span<Reinsertion> reinsertions);
    void reinsert_node(const Reinsertion& reinsertion);
    void write_node(std::uint32_t index, const Node& node, bool is_group_root);
    void set_parent_of_children(std::uint32_t index);
    void refit_from(std::uint32_t index);

    /// What a node was before it was written.
    struct UndoEntry {
        std::uint32_t index;
        bool is_group_root;
        Node node;
    };

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> parents_;
    std::vector<std::uint8_t> is_group_root_;  // empty without groups
    std::vector<std::uint8_t> is_touched_;     // with a reinsertion of this batch
    std::vector<std::uint8_t> is_settled_;     // its children found no better place
    std::vector<UndoEntry> undo_;              // writes since the best state
    double best_area_ = 0.0;                   // the least inner_area() so far
    double area_growth_ = 0.0;                 // over it
    int batches_without_gain_ = 0;
};

}  // namespace earshot::bvh
