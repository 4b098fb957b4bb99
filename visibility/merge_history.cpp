// SPDX-License-Identifier: MIT
#include "earshot/visibility/merge_history.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/visibility/render_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace earshot::visibility {

namespace {

[[noreturn]] void fail(const char* what) {
    throw Error("merge history", what, "merge the cells again");
}

}  // namespace

MergeHistory::MergeHistory(double leaf_cost,
                           std::vector<std::uint64_t> leaf_entries,
                           std::vector<CellMerge> merges)
    : leaf_cost_(leaf_cost), leaf_entries_(std::move(leaf_entries)), merges_(std::move(merges)) {
    if (leaves() == 0 || leaves() > ViewCells::kMaxLeaves || merges_.size() + 1 != leaves()) {
        fail("the numbers of steps and leaves do not fit each other");
    }
    std::vector<std::uint8_t> is_used(2 * leaves(), 0);
    double cost = leaf_cost_;
    for (std::size_t k = 0; k < merges_.size(); ++k) {
        const CellMerge& merge = merges_[k];
        if (merge.first >= merge.second || merge.second >= leaves() + k ||
            std::exchange(is_used[merge.first], 1) != 0 ||
            std::exchange(is_used[merge.second], 1) != 0) {
            fail("a step merges a group that does not exist");
        }
        const std::uint64_t first = entries_in(merge.first);
        const std::uint64_t second = entries_in(merge.second);
        if (merge.entries < std::max(first, second) || merge.entries - first > second) {
            fail("a set is no union of its parts");
        }
        if (!(merge.cost >= cost)) {
            fail("the cost falls");
        }
        cost = merge.cost;
    }
    if (!std::isfinite(cost)) {
        fail("a cost is not finite");
    }
}

MergeHistory MergeHistory::with_entries_of(std::span<const std::vector<ObjectId>> sets) const {
    if (sets.size() != leaves()) {
        fail("there is not a set per leaf");
    }
    MergeHistory result = *this;
    std::vector<std::vector<ObjectId>> groups(sets.begin(), sets.end());
    for (std::size_t i = 0; i < leaves(); ++i) {
        result.leaf_entries_[i] = sets[i].size();
    }
    for (CellMerge& merge : result.merges_) {
        groups.push_back(union_of(groups[merge.first], groups[merge.second]));
        merge.entries = groups.back().size();
        groups[merge.first] = {};
        groups[merge.second] = {};
    }
    return result;
}

std::size_t MergeHistory::cells_by_cost(double ratio) const {
    if (!(ratio >= 1.0)) {
        throw Error("cost ratio",
                    "merged cells cannot cost less than " + std::to_string(ratio) +
                        " times the unmerged ones",
                    "give a ratio of at least 1");
    }
    const double limit = ratio * leaf_cost_;
    const auto first_above =
        std::partition_point(merges_.begin(), merges_.end(), [&](const CellMerge& merge) {
            return merge.cost <= limit;
        });
    return leaves() - static_cast<std::size_t>(first_above - merges_.begin());
}

std::size_t MergeHistory::cells_by_memory(const Memory& memory) const {
    // Every merge leaves fewer cells and, as a union is no larger than its parts, no more entries.
    std::uint64_t entries =
        std::accumulate(leaf_entries_.begin(), leaf_entries_.end(), std::uint64_t{0});
    std::uint64_t bytes = 0;
    for (std::size_t merged = 0; merged < leaves(); ++merged) {
        const std::size_t cells = leaves() - merged;
        bytes = memory.bytes_per_entry * entries + memory.bytes_per_cell * cells;
        if (bytes <= memory.bytes) {
            return cells;
        }
        if (merged < merges_.size()) {
            entries -= entries_saved(merged);
        }
    }
    throw Error("memory",
                "a single cell takes " + std::to_string(bytes) + " bytes, of " +
                    std::to_string(memory.bytes),
                "allow more, or use larger objects");
}

std::uint64_t MergeHistory::entries_in(std::uint32_t group) const noexcept {
    return group < leaves() ? leaf_entries_[group] : merges_[group - leaves()].entries;
}

std::uint64_t MergeHistory::entries_saved(std::size_t merge) const noexcept {
    const CellMerge& step = merges_[merge];
    return entries_in(step.first) + entries_in(step.second) - step.entries;
}

double MergeHistory::cost_of(std::size_t cells) const noexcept {
    EARSHOT_ASSERT(cells >= 1 && cells <= leaves());
    return cells == leaves() ? leaf_cost_ : merges_[leaves() - cells - 1].cost;
}

std::uint64_t MergeHistory::entries_of(std::size_t cells) const noexcept {
    EARSHOT_ASSERT(cells >= 1 && cells <= leaves());
    std::uint64_t entries =
        std::accumulate(leaf_entries_.begin(), leaf_entries_.end(), std::uint64_t{0});
    for (std::size_t merge = 0; merge < leaves() - cells; ++merge) {
        entries -= entries_saved(merge);
    }
    return entries;
}

std::vector<CellId> MergeHistory::extract(std::size_t cells) const {
    EARSHOT_ASSERT(cells > 0);
    // Taking the group of the highest cost apart first, of equals the latest, undoes the steps from
    // the last one back: costs never fall on the way.
    const std::size_t steps = leaves() - std::min(cells, leaves());
    std::vector<std::uint32_t> whole(leaves() + steps);
    std::iota(whole.begin(), whole.end(), 0U);
    for (std::size_t k = steps; k-- > 0;) {
        whole[merges_[k].first] = whole[leaves() + k];
        whole[merges_[k].second] = whole[leaves() + k];
    }
    constexpr CellId kNone = std::numeric_limits<CellId>::max();
    std::vector<CellId> number(whole.size(), kNone);
    std::vector<CellId> cell_of_leaf(leaves());
    CellId next = 0;
    for (std::size_t leaf = 0; leaf < leaves(); ++leaf) {
        CellId& cell = number[whole[leaf]];
        cell = cell == kNone ? next++ : cell;
        cell_of_leaf[leaf] = cell;
    }
    return cell_of_leaf;
}

}  // namespace earshot::visibility
