// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/reinsertion_optimiser.h"

#include "earshot/bvh/grouped_tree.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::uint32_t kRoot = 0;

Aabb united(Aabb a, const Aabb& b) noexcept {
    a.include(b);
    return a;
}

}  // namespace

ReinsertionOptimiser::ReinsertionOptimiser(std::span<const Node> nodes,
                                           std::span<const std::uint32_t> group_of_node)
    : nodes_(nodes.begin(), nodes.end()), parents_(nodes.size(), kRoot) {
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        set_parent_of_children(i);
    }
    // A group's root is the node below which all belong to it, and above which none does.
    if (!group_of_node.empty()) {
        is_group_root_.resize(nodes_.size(), 0);
        for (std::uint32_t i = 1; i < nodes_.size(); ++i) {
            is_group_root_[i] =
                group_of_node[i] != kMixedGroups && group_of_node[parents_[i]] == kMixedGroups;
        }
    }
}

void ReinsertionOptimiser::set_parent_of_children(std::uint32_t index) {
    if (!nodes_[index].is_leaf()) {
        parents_[nodes_[index].first] = index;
        parents_[nodes_[index].first + 1] = index;
    }
}

// Bittner, Hapala and Havran 2013, section 3.3, rank nodes by an inefficiency measure that combines
// their area with the ratios of it to the areas of their children. The area alone selects equally
// good candidates here and costs one pass over the nodes.
std::vector<std::uint32_t> ReinsertionOptimiser::find_candidates(std::size_t count,
                                                                 Executor& executor) const {
    struct Candidate {
        // Below 0: the root and its children, which cannot be reinserted, nor can those of a
        // group's root.
        double area;
        std::uint32_t index;
    };
    std::vector<Candidate> all(nodes_.size());
    constexpr std::size_t kGrain = 16384;
    executor.for_each(nodes_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto index = static_cast<std::uint32_t>(i);
            all[i] = {index == kRoot || is_top(parents_[i]) ? -1.0 : area(index), index};
        }
    });
    const auto is_larger = [](const Candidate& a, const Candidate& b) {
        return a.area != b.area ? a.area > b.area : a.index < b.index;
    };
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(count, all.size()));
    std::nth_element(all.begin(), end, all.end(), is_larger);
    std::vector<std::uint32_t> candidates;
    for (auto candidate = all.begin(); candidate != end; ++candidate) {
        if (candidate->area > 0.0) {
            candidates.push_back(candidate->index);
        }
    }
    std::sort(candidates.begin(), candidates.end());
    return candidates;
}

// Meister and Bittner 2018, section 4.1. The search climbs from the removed node to the root; at
// every ancestor (the pivot) it descends into the pivot's other child:
//
//          root                     Removing `from` saves the area of its parent, whose place the
//         /    \                    sibling takes, and shrinks the pivots above:
//     pivot     other (2nd)             area_diff = area(parent)
//     /    \                                        + sum of (area(pivot) - area(pivot_box))
//  parent   other (1st)             where `pivot_box` is the pivot's box without `from`. Inserting
//   /  \       / \                  `from` as the sibling of a node below the other child costs the
// from sibling a  b                 area of the new parent and the growth of the nodes above it.
//
// Subtrees that cannot reduce the area more than the best reinsertion so far are pruned: a new
// parent is never smaller than the node inserted.
ReinsertionOptimiser::Reinsertion ReinsertionOptimiser::find_reinsertion(std::uint32_t from) const {
    const double from_area = area(from);
    const Aabb& box = nodes_[from].box;
    const std::uint32_t parent = parents_[from];
    Reinsertion best = {from, kRoot, 0.0};
    struct StackEntry {
        double area_diff;  // before the area of the new parent is subtracted
        std::uint32_t node;
    };
    std::vector<StackEntry> stack;
    std::uint32_t pivot = parent;
    std::uint32_t other_child = sibling(from);
    Aabb pivot_box = nodes_[other_child].box;
    double area_diff = area(parent);
    while (true) {
        // Descend into the other child of the pivot.
        stack.push_back({area_diff, other_child});
        while (!stack.empty()) {
            const StackEntry top = stack.back();
            stack.pop_back();
            if (!(top.area_diff - from_area > best.area_diff)) {
                continue;
            }
            const Node& node = nodes_[top.node];
            const double diff_as_sibling = top.area_diff - united(node.box, box).half_area();
            if (diff_as_sibling > best.area_diff) {
                best.to = top.node;
                best.area_diff = diff_as_sibling;
            }
            if (!node.is_leaf() && !is_barrier(top.node)) {
                // If `from` is inserted deeper, the box of this node grows to enclose it.
                const double diff_below = diff_as_sibling + node.box.half_area();
                stack.push_back({diff_below, node.first});
                stack.push_back({diff_below, node.first + 1});
            }
        }
        // The pivot's box shrinks, and the pivot itself may become the new sibling.
        if (pivot != parent) {
            pivot_box.include(nodes_[other_child].box);
            area_diff += area(pivot) - pivot_box.half_area();
            const double diff_as_sibling = area_diff - united(pivot_box, box).half_area();
            if (!is_top(pivot) && diff_as_sibling > best.area_diff) {
                best.to = pivot;
                best.area_diff = diff_as_sibling;
            }
        }
        if (is_top(pivot)) {
            break;
        }
        other_child = sibling(pivot);
        pivot = parents_[pivot];
    }
    const bool is_unchanged = best.to == kRoot || best.to == sibling(from) || best.to == parent;
    return is_unchanged ? Reinsertion{from, kRoot, 0.0} : best;
}

/// The nodes whose links a reinsertion reads or changes. Two reinsertions that share such a node
/// conflict: only one of them is made in a batch.
std::array<std::uint32_t, 6> ReinsertionOptimiser::get_conflicts(
    const Reinsertion& reinsertion) const noexcept {
    const std::uint32_t parent = parents_[reinsertion.from];
    return {reinsertion.to,
            parents_[reinsertion.to],
            reinsertion.from,
            sibling(reinsertion.from),
            parent,
            parents_[parent]};
}

// All nodes but three keep their index: the sibling moves to the index of the parent; the pair of
// indices that becomes free holds the inserted node and the node that was at `to`; and the node at
// the index of `to` becomes the new parent of that pair.
//
//        |           |                        |           |
//      parent       to                     sibling    new parent
//      /    \      /  \          =>        /     \     /      \            .
//   from  sibling  .  .                   c       d  from     to
//         /    \                                             /  \          .
//        c      d
void ReinsertionOptimiser::move_node(std::uint32_t from, std::uint32_t to) {
    nodes_[to] = nodes_[from];
    if (!is_group_root_.empty()) {
        is_group_root_[to] = is_group_root_[from];
    }
    set_parent_of_children(to);
}

void ReinsertionOptimiser::reinsert_node(const Reinsertion& reinsertion) {
    const std::uint32_t parent = parents_[reinsertion.from];
    const std::uint32_t sibling_index = sibling(reinsertion.from);
    move_node(sibling_index, parent);
    move_node(reinsertion.to, sibling_index);
    nodes_[reinsertion.to] = {
        .box = united(nodes_[sibling_index].box, nodes_[reinsertion.from].box),
        .first = std::min(reinsertion.from, sibling_index)};
    if (!is_group_root_.empty()) {
        is_group_root_[reinsertion.to] = 0;
    }
    set_parent_of_children(reinsertion.to);
    refit_from(parents_[parent]);
    refit_from(parents_[reinsertion.to]);
}

void ReinsertionOptimiser::refit_from(std::uint32_t index) {
    while (true) {
        Node& node = nodes_[index];
        if (!node.is_leaf()) {
            const Aabb box = united(nodes_[node.first].box, nodes_[node.first + 1].box);
            if (box == node.box) {
                return;
            }
            node.box = box;
        }
        if (index == kRoot) {
            return;
        }
        index = parents_[index];
    }
}

std::size_t ReinsertionOptimiser::reinsert_batch(std::size_t batch_size, Executor& executor) {
    // In a tree of fewer than five nodes every node is the root or a child of the root.
    if (nodes_.size() < 5) {
        return 0;
    }
    // Search in parallel. The tree is not changed during the search.
    const std::vector<std::uint32_t> candidates = find_candidates(batch_size, executor);
    std::vector<Reinsertion> reinsertions(candidates.size());
    constexpr std::size_t kGrain = 256;
    executor.for_each(reinsertions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            reinsertions[i] = find_reinsertion(candidates[i]);
        }
    });
    // Make the reinsertions one by one, those that reduce the area most first.
    std::erase_if(reinsertions, [](const Reinsertion& found) { return found.to == kRoot; });
    std::sort(
        reinsertions.begin(), reinsertions.end(), [](const Reinsertion& a, const Reinsertion& b) {
            return a.area_diff != b.area_diff ? a.area_diff > b.area_diff : a.from < b.from;
        });
    is_touched_.assign(nodes_.size(), 0);
    std::size_t count = 0;
    for (const Reinsertion& reinsertion : reinsertions) {
        const auto conflicts = get_conflicts(reinsertion);
        if (std::any_of(conflicts.begin(), conflicts.end(), [&](std::uint32_t index) {
                return is_touched_[index] != 0;
            })) {
            continue;
        }
        for (const std::uint32_t index : conflicts) {
            is_touched_[index] = 1;
        }
        reinsert_node(reinsertion);
        ++count;
    }
    return count;
}

double ReinsertionOptimiser::inner_area() const noexcept {
    double sum = 0.0;
    for (const Node& node : nodes_) {
        sum += node.is_leaf() ? 0.0 : node.box.half_area();
    }
    return sum;
}

std::vector<Node> ReinsertionOptimiser::depth_first_nodes(std::size_t max_depth) const {
    struct StackEntry {
        std::uint32_t source, target;
        std::size_t depth;
    };
    std::vector<Node> result;
    result.reserve(nodes_.size());
    result.push_back(nodes_[kRoot]);
    std::vector<StackEntry> stack = {{kRoot, 0, 0}};
    while (!stack.empty()) {
        const StackEntry top = stack.back();
        stack.pop_back();
        if (top.depth > max_depth) {
            return {};
        }
        const Node& node = nodes_[top.source];
        if (node.is_leaf()) {
            continue;
        }
        const auto left = static_cast<std::uint32_t>(result.size());
        result[top.target].first = left;
        result.push_back(nodes_[node.first]);
        result.push_back(nodes_[node.first + 1]);
        stack.push_back({node.first + 1, left + 1, top.depth + 1});
        stack.push_back({node.first, left, top.depth + 1});
    }
    return result;
}

}  // namespace earshot::bvh
