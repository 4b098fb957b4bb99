// SPDX-License-Identifier: MIT
#include "earshot/visibility/merge_history.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

namespace earshot::visibility {
namespace {

using Cells = std::vector<CellId>;

constexpr std::uint64_t kSeed = 4;

/// Four cells in a row that see {A, B}, {A, B}, {B, C} and {C}.
MergeHistory four() {
    return {1.75, {2, 2, 2, 1}, {{0, 1, 1.75, 2}, {2, 3, 2.0, 2}, {4, 5, 3.0, 3}}};
}

/// Random pairs, some of them without cost.
MergeHistory random_history(std::size_t leaves) {
    std::vector<std::uint32_t> groups(leaves);
    std::vector<std::uint64_t> entries(leaves);
    for (std::size_t i = 0; i < leaves; ++i) {
        groups[i] = static_cast<std::uint32_t>(i);
        entries[i] = random_bits(kSeed, 0, i) % 50;
    }
    auto known = entries;
    std::vector<CellMerge> merges;
    double cost = 7.0;
    while (groups.size() > 1) {
        const auto draw = [&](std::uint64_t stream) {
            const std::size_t place = random_bits(kSeed, stream, groups.size()) % groups.size();
            const std::uint32_t group = groups[place];
            groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(place));
            return group;
        };
        const std::uint32_t a = draw(1);
        const std::uint32_t b = draw(2);
        cost += random(kSeed, 3, groups.size()) < 0.3 ? 0.0 : random(kSeed, 4, groups.size());
        const std::uint64_t larger = std::max(known[a], known[b]);
        const std::uint64_t smaller = std::min(known[a], known[b]);
        known.push_back(larger + random_bits(kSeed, 5, groups.size()) % (smaller + 1));
        merges.push_back({std::min(a, b), std::max(a, b), cost, known.back()});
        groups.push_back(static_cast<std::uint32_t>(leaves + merges.size() - 1));
    }
    return {7.0, entries, merges};
}

/// Extraction as it is published: from the root, the group of the highest cost is taken apart, of
/// equals the latest. Returns the groups.
std::set<std::uint32_t> by_priority(const MergeHistory& history, std::size_t cells) {
    const auto leaves = static_cast<std::uint32_t>(history.leaves());
    std::priority_queue<std::pair<double, std::uint32_t>> queue;
    std::set<std::uint32_t> done;
    const auto add = [&](std::uint32_t group) {
        if (group < leaves) {
            done.insert(group);
        } else {
            queue.push({history.merges()[group - leaves].cost, group});
        }
    };
    add(static_cast<std::uint32_t>(leaves + history.merges().size() - 1));
    while (done.size() + queue.size() < cells) {
        const std::uint32_t group = queue.top().second;
        queue.pop();
        add(history.merges()[group - leaves].first);
        add(history.merges()[group - leaves].second);
    }
    for (; !queue.empty(); queue.pop()) {
        done.insert(queue.top().second);
    }
    return done;
}

void collect(const MergeHistory& history, std::uint32_t group, std::set<LeafId>& leaves) {
    if (group < history.leaves()) {
        leaves.insert(group);
        return;
    }
    collect(history, history.merges()[group - history.leaves()].first, leaves);
    collect(history, history.merges()[group - history.leaves()].second, leaves);
}

std::set<std::set<LeafId>> as_sets(const Cells& cell_of_leaf) {
    std::map<CellId, std::set<LeafId>> cells;
    for (LeafId leaf = 0; leaf < cell_of_leaf.size(); ++leaf) {
        cells[cell_of_leaf[leaf]].insert(leaf);
    }
    std::set<std::set<LeafId>> sets;
    for (const auto& [cell, leaves] : cells) {
        sets.insert(leaves);
    }
    return sets;
}

TEST(MergeHistory, GivesAsManyCellsAsAskedFor) {
    EXPECT_EQ(four().extract(3), (Cells{0, 0, 1, 2}));
    EXPECT_EQ(four().extract(2), (Cells{0, 0, 1, 1}));
    EXPECT_EQ(four().extract(1), (Cells{0, 0, 0, 0}));
    EXPECT_EQ(four().extract(4), (Cells{0, 1, 2, 3}));
    EXPECT_EQ(four().extract(100), (Cells{0, 1, 2, 3}));
}

TEST(MergeHistory, GivesTheFewestCellsThatCostNoMuchMore) {
    EXPECT_EQ(four().cells_by_cost(1.0), 3U);
    EXPECT_EQ(four().cells_by_cost(1.1), 3U);
    EXPECT_EQ(four().cells_by_cost(8.0 / 7.0), 2U);
    EXPECT_EQ(four().cells_by_cost(1.7), 2U);
    EXPECT_EQ(four().cells_by_cost(2.0), 1U);
}

TEST(MergeHistory, ExtractsByUndoingTheLastMerges) {
    const MergeHistory history = random_history(60);
    for (std::size_t cells = 1; cells <= 60; ++cells) {
        std::set<std::set<LeafId>> expected;
        std::size_t leaves = 0;
        for (const std::uint32_t group : by_priority(history, cells)) {
            std::set<LeafId> members;
            collect(history, group, members);
            leaves += members.size();
            expected.insert(members);
        }
        // A cut: each leaf once.
        ASSERT_EQ(leaves, 60U);
        ASSERT_EQ(as_sets(history.extract(cells)), expected) << cells << " cells";
        ASSERT_EQ(expected.size(), cells);
    }
}

TEST(MergeHistory, ExtractsThePartitionAfterSoManyMerges) {
    const MergeHistory history = random_history(60);
    std::map<std::uint32_t, std::set<LeafId>> groups;
    for (LeafId leaf = 0; leaf < 60; ++leaf) {
        groups[leaf] = {leaf};
    }
    std::uint32_t next = 60;
    for (const CellMerge& merge : history.merges()) {
        auto both = groups[merge.first];
        both.insert(groups[merge.second].begin(), groups[merge.second].end());
        groups.erase(merge.first);
        groups.erase(merge.second);
        groups[next++] = both;
        std::set<std::set<LeafId>> expected;
        for (const auto& [number, leaves] : groups) {
            expected.insert(leaves);
        }
        ASSERT_EQ(as_sets(history.extract(groups.size())), expected);
        ASSERT_EQ(history.cost_of(groups.size()), merge.cost);
    }
}

TEST(MergeHistory, NumbersCellsByTheirLowestLeaf) {
    const Cells cells = random_history(60).extract(20);
    CellId next = 0;
    for (const CellId cell : cells) {
        ASSERT_LE(cell, next);
        next = std::max(next, cell + 1);
    }
    EXPECT_EQ(next, 20U);
}

TEST(MergeHistory, KeepsToItsMemoryAndUsesIt) {
    // By hand: 7 entries and 4 cells, 5 and 3, 4 and 2, 3 and 1.
    const auto cells = [](std::uint64_t bytes) { return four().cells_by_memory({bytes, 4, 10}); };
    EXPECT_EQ(cells(7 * 4 + 40), 4U);
    EXPECT_EQ(cells(7 * 4 + 39), 3U);
    EXPECT_EQ(cells(5 * 4 + 30), 3U);
    EXPECT_EQ(cells(5 * 4 + 29), 2U);
    EXPECT_EQ(cells(3 * 4 + 10), 1U);
    EXPECT_THROW(cells(3 * 4 + 9), Error);

    const MergeHistory history = random_history(60);
    for (std::uint64_t bytes = 2000; bytes < 12000; bytes += 100) {
        const std::size_t count = history.cells_by_memory({bytes, 4, 32});
        EXPECT_LE(4 * history.entries_of(count) + 32 * count, bytes);
        if (count < 60) {
            EXPECT_GT(4 * history.entries_of(count + 1) + 32 * (count + 1), bytes);
        }
    }
}

TEST(MergeHistory, CountsTheEntriesOfOtherSets) {
    const std::vector<std::vector<ObjectId>> sets = {{0}, {0, 1, 2}, {5}, {1, 5, 6}};
    const MergeHistory other = four().with_entries_of(sets);
    EXPECT_EQ(other.entries_of(4), 8U);
    EXPECT_EQ(other.entries_of(3), 7U);
    EXPECT_EQ(other.entries_of(2), 6U);
    EXPECT_EQ(other.entries_of(1), 5U);
    EXPECT_EQ(other.cost_of(2), 2.0);
    EXPECT_THROW(four().with_entries_of(std::span(sets).first(3)), Error);
}

TEST(MergeHistory, RefusesStepsThatAreNone) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(four().cells_by_cost(0.99), Error);
    EXPECT_THROW(four().cells_by_cost(nan), Error);
    using Merges = std::vector<CellMerge>;
    EXPECT_THROW(MergeHistory(1.0, {}, {}), Error);
    EXPECT_THROW(MergeHistory(1.0, {1, 1}, {}), Error);
    EXPECT_THROW(MergeHistory(1.0, {1, 1}, Merges{{0, 0, 1.0, 1}}), Error);
    EXPECT_THROW(MergeHistory(1.0, {1, 1}, Merges{{0, 2, 1.0, 1}}), Error);
    EXPECT_THROW(MergeHistory(1.0, {1, 1}, Merges{{0, 1, 0.5, 1}}), Error);
    EXPECT_THROW(MergeHistory(1.0, {1, 1}, Merges{{0, 1, nan, 1}}), Error);
    EXPECT_THROW(MergeHistory(1.0, {1, 1, 1}, Merges{{0, 1, 1.0, 1}, {0, 3, 1.0, 1}}), Error);
    // A union has as many entries as its largest part at least, and as all together at most.
    EXPECT_THROW(MergeHistory(1.0, {2, 3}, Merges{{0, 1, 1.0, 2}}), Error);
    EXPECT_THROW(MergeHistory(1.0, {2, 3}, Merges{{0, 1, 1.0, 6}}), Error);
    EXPECT_NO_THROW(MergeHistory(1.0, {2, 3}, Merges{{0, 1, 1.0, 5}}));
}

}  // namespace
}  // namespace earshot::visibility
