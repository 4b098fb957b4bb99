// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/reinsertion_optimiser.h"

#include "earshot/bvh/grouped_tree.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::uint32_t kRoot = 0;

// The limit p_T of Bittner, Hapala and Havran 2013.
constexpr int kMaxBatchesWithoutGain = 10;
// Of the inner area, well above what rounding adds up to.
constexpr double kMinGain = 1e-9;

Aabb united(Aabb a, const Aabb& b) noexcept {
    a.include(b);
    return a;
}

}  // namespace

ReinsertionOptimiser::ReinsertionOptimiser(std::span<const Node> nodes,
                                           std::span<const std::uint32_t> group_of_node)
    : nodes_(nodes.begin(), nodes.end()),
      parents_(nodes.size(), kRoot),
      is_settled_(nodes.size(), 0) {
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
    best_area_ = inner_area();
}

void ReinsertionOptimiser::set_parent_of_children(std::uint32_t index) {
    if (!nodes_[index].is_leaf()) {
        parents_[nodes_[index].first] = index;
        parents_[nodes_[index].first + 1] = index;
    }
}

// Bittner, Hapala and Havran 2013, section 3.3: the combined measure M_SUM * M_MIN * M_AREA, the
// node's area over the mean of its children's, over the least of them, and itself. A node ranks
// high if it is large and its children are small or one of them is: they lie far apart, so that one
// of them had better be elsewhere.
double ReinsertionOptimiser::inefficiency(std::uint32_t index) const noexcept {
    // Children without an area, such as points, would outrank everything.
    constexpr double kMinChildRatio = 0.01;
    const double own = area(index);
    if (!(own > 0.0)) {
        return 0.0;
    }
    const double left = std::max(area(nodes_[index].first), kMinChildRatio * own);
    const double right = std::max(area(nodes_[index].first + 1), kMinChildRatio * own);
    return own / (0.5 * (left + right)) * (own / std::min(left, right)) * own;
}

/// The children of the `count` most inefficient nodes, by index. Neither the root's children nor
/// those of a group's root can be reinserted. Nodes whose children have found no better place are
/// passed over, so that later batches go on to others, which Bittner, Hapala and Havran reach by
/// random picks.
std::vector<std::uint32_t> ReinsertionOptimiser::find_candidates(std::size_t count,
                                                                 Executor& executor) const {
    struct Candidate {
        double inefficiency;
        std::uint32_t index;
    };
    std::vector<Candidate> all(nodes_.size());
    constexpr std::size_t kGrain = 16384;
    executor.for_each(nodes_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto index = static_cast<std::uint32_t>(i);
            const bool is_candidate =
                !nodes_[index].is_leaf() && !is_top(index) && is_settled_[index] == 0;
            all[i] = {is_candidate ? inefficiency(index) : 0.0, index};
        }
    });
    std::erase_if(all, [](const Candidate& candidate) { return candidate.inefficiency <= 0.0; });
    if (count < all.size()) {
        const auto is_worse = [](const Candidate& a, const Candidate& b) {
            return a.inefficiency != b.inefficiency ? a.inefficiency > b.inefficiency
                                                    : a.index < b.index;
        };
        const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
        std::nth_element(all.begin(), end, all.end(), is_worse);
        all.erase(end, all.end());
    }
    std::vector<std::uint32_t> candidates;
    for (const Candidate& candidate : all) {
        candidates.push_back(nodes_[candidate.index].first);
        candidates.push_back(nodes_[candidate.index].first + 1);
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

void ReinsertionOptimiser::write_node(std::uint32_t index, const Node& node, bool is_group_root) {
    const auto inner_area_of = [](const Node& of) {
        return of.is_leaf() ? 0.0 : of.box.half_area();
    };
    undo_.push_back({index, is_barrier(index), nodes_[index]});
    area_growth_ += inner_area_of(node) - inner_area_of(nodes_[index]);
    nodes_[index] = node;
    if (!is_group_root_.empty()) {
        is_group_root_[index] = is_group_root ? 1 : 0;
    }
    set_parent_of_children(index);
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
void ReinsertionOptimiser::reinsert_node(const Reinsertion& reinsertion) {
    const std::uint32_t parent = parents_[reinsertion.from];
    const std::uint32_t sibling_index = sibling(reinsertion.from);
    const std::uint32_t to = reinsertion.to;
    write_node(parent, nodes_[sibling_index], is_barrier(sibling_index));
    write_node(sibling_index, nodes_[to], is_barrier(to));
    write_node(to,
               {.box = united(nodes_[sibling_index].box, nodes_[reinsertion.from].box),
                .first = std::min(reinsertion.from, sibling_index)},
               false);
    refit_from(parents_[parent]);
    refit_from(parents_[to]);
}

void ReinsertionOptimiser::refit_from(std::uint32_t index) {
    while (true) {
        Node node = nodes_[index];
        if (!node.is_leaf()) {
            node.box = united(nodes_[node.first].box, nodes_[node.first + 1].box);
            if (node.box == nodes_[index].box) {
                return;
            }
            write_node(index, node, is_barrier(index));
        }
        if (index == kRoot) {
            return;
        }
        index = parents_[index];
    }
}

std::optional<std::size_t> ReinsertionOptimiser::reinsert_batch(std::size_t batch_size,
                                                                Executor& executor) {
    // Search in parallel. The tree is not changed during the search.
    const std::size_t pairs = (batch_size + 1) / 2;
    if (batches_without_gain_ == kMaxBatchesWithoutGain) {
        return std::nullopt;
    }
    const std::vector<std::uint32_t> candidates = find_candidates(pairs, executor);
    if (candidates.empty()) {
        return std::nullopt;
    }
    std::vector<Reinsertion> reinsertions(candidates.size());
    constexpr std::size_t kGrain = 256;
    executor.for_each(reinsertions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            reinsertions[i] = find_reinsertion(candidates[i]);
        }
    });
    for (std::size_t i = 0; i < reinsertions.size(); i += 2) {
        is_settled_[parents_[candidates[i]]] =
            reinsertions[i].to == kRoot && reinsertions[i + 1].to == kRoot;
    }
    std::erase_if(reinsertions, [](const Reinsertion& found) { return found.to == kRoot; });
    const std::size_t count = make_reinsertions(reinsertions);
    // Reinsertions that gain by themselves may lose together.
    ++batches_without_gain_;
    if (area_growth_ < -kMinGain * best_area_) {
        batches_without_gain_ = 0;
        best_area_ += area_growth_;
        area_growth_ = 0.0;
        undo_.clear();
    }
    return count;
}

/// Makes the reinsertions one by one, those that reduce the area most first.
std::size_t ReinsertionOptimiser::make_reinsertions(std::span<Reinsertion> reinsertions) {
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
            is_settled_[index] = 0;
        }
        reinsert_node(reinsertion);
        ++count;
    }
    return count;
}

void ReinsertionOptimiser::restore_best() {
    for (auto entry = undo_.rbegin(); entry != undo_.rend(); ++entry) {
        nodes_[entry->index] = entry->node;
        if (!is_group_root_.empty()) {
            is_group_root_[entry->index] = entry->is_group_root ? 1 : 0;
        }
    }
    for (const UndoEntry& entry : undo_) {
        set_parent_of_children(entry.index);
    }
    area_growth_ = 0.0;
    undo_.clear();
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
