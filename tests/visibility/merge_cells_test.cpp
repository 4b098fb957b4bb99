// SPDX-License-Identifier: MIT
#include "earshot/visibility/merge_cells.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/visibility/internal/cell_adjacency.h"
#include "earshot/visibility/render_cost.h"

#include <gtest/gtest.h>

#include "visibility/random_cells.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace earshot::visibility {
namespace {

using geometry::Vec3;
using Sets = std::vector<std::vector<ObjectId>>;

constexpr std::uint64_t kSeed = 21;

ViewCells row_of_four() {
    return ViewCells::grid({Vec3(0.0), {4.0, 1.0, 1.0}}, {4, 1, 1});
}

/// Sets of which those of neighbours by number resemble each other.
Sets random_sets(std::size_t count, ObjectId objects) {
    Sets sets(count);
    for (std::size_t i = 0; i < count; ++i) {
        for (ObjectId object = 0; object < objects; ++object) {
            if (random(kSeed, i / 2, object) < 0.3 || random(kSeed, 1000 + i, object) < 0.1) {
                sets[i].push_back(object);
            }
        }
    }
    return sets;
}

std::vector<double> random_numbers(std::size_t count, std::uint64_t stream) {
    std::vector<double> numbers(count);
    for (std::size_t i = 0; i < count; ++i) {
        numbers[i] = random_between(kSeed, stream, i, 0.5, 3.0);
    }
    return numbers;
}

/// The same by definition: every pair of neighbours in turn, and the cost of all cells anew.
class SlowMerger {
public:
    struct Group {
        double share;
        std::set<ObjectId> set;
        std::set<LeafId> leaves;
    };

    SlowMerger(const ViewCells& cells,
               const Sets& sets,
               std::vector<double> costs,
               const std::vector<double>& viewer_fractions)
        : costs_(std::move(costs)) {
        for (const CellAdjacency& contact : cell_adjacencies(cells)) {
            contacts_.insert({contact.first, contact.second});
        }
        for (LeafId i = 0; i < sets.size(); ++i) {
            groups[i] = {viewer_fractions[i], {sets[i].begin(), sets[i].end()}, {i}};
        }
        next_ = static_cast<std::uint32_t>(sets.size());
    }

    double cost() const {
        double sum = 0.0;
        for (const auto& [number, group] : groups) {
            for (const ObjectId object : group.set) {
                sum += group.share * costs_[object];
            }
        }
        return sum;
    }

    std::optional<std::pair<std::uint32_t, std::uint32_t>> merge() {
        std::optional<std::pair<std::uint32_t, std::uint32_t>> best;
        double least = std::numeric_limits<double>::infinity();
        for (const auto& [a, first] : groups) {
            for (const auto& [b, second] : groups) {
                if (a >= b || !touch(first, second)) {
                    continue;
                }
                SlowMerger trial = *this;
                trial.join(a, b);
                // Numbers that differ by their rounding are equal.
                if (const double cost = trial.cost(); cost < least - 1e-11) {
                    least = cost;
                    best = {a, b};
                }
            }
        }
        if (best) {
            join(best->first, best->second);
        }
        return best;
    }

    std::map<std::uint32_t, Group> groups;

private:
    bool touch(const Group& a, const Group& b) const {
        for (const LeafId i : a.leaves) {
            for (const LeafId k : b.leaves) {
                if (contacts_.contains(std::minmax(i, k))) {
                    return true;
                }
            }
        }
        return false;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        Group both = groups[a];
        both.share += groups[b].share;
        both.set.insert(groups[b].set.begin(), groups[b].set.end());
        both.leaves.insert(groups[b].leaves.begin(), groups[b].leaves.end());
        groups.erase(a);
        groups.erase(b);
        groups[next_++] = both;
    }

    std::vector<double> costs_;
    std::set<std::pair<LeafId, LeafId>> contacts_;
    std::uint32_t next_ = 0;
};

TEST(MergeCells, OfFourInARow) {
    // A, B, C are 0, 1, 2.
    const Sets sets = {{0, 1}, {0, 1}, {1, 2}, {2}};
    const auto history = merge_cells(row_of_four(), sets, std::vector<double>(3, 1.0));
    EXPECT_EQ(history.leaf_cost(), 7.0 / 4.0);
    ASSERT_EQ(history.merges().size(), 3U);
    EXPECT_EQ(history.merges()[0], (CellMerge{0, 1, 7.0 / 4.0, 2}));
    EXPECT_EQ(history.merges()[1], (CellMerge{2, 3, 2.0, 2}));
    EXPECT_EQ(history.merges()[2], (CellMerge{4, 5, 3.0, 3}));
    // The ratios 1, 8/7 and 3/2.
    EXPECT_EQ(history.cost_of(3) / history.cost_of(4), 1.0);
    EXPECT_EQ(history.cost_of(2) / history.cost_of(3), 8.0 / 7.0);
    EXPECT_EQ(history.cost_of(1) / history.cost_of(2), 3.0 / 2.0);
}

TEST(MergeCells, MergesTheBestOfAllPairs) {
    const ViewCells cells = test::random_cells(kSeed, 16);
    const Sets sets = random_sets(16, 20);
    const auto costs = random_numbers(20, 1);
    auto viewer_fractions = random_numbers(16, 2);
    for (double& share : viewer_fractions) {
        share /= 40.0;
    }
    const auto history = merge_cells(cells, sets, costs, viewer_fractions);
    SlowMerger slow(cells, sets, costs, viewer_fractions);
    EXPECT_NEAR(history.leaf_cost(), slow.cost(), 1e-12);
    for (const CellMerge& merge : history.merges()) {
        const auto expected = slow.merge();
        ASSERT_TRUE(expected);
        EXPECT_EQ(std::pair(merge.first, merge.second), *expected);
        EXPECT_NEAR(merge.cost, slow.cost(), 1e-12);
        EXPECT_EQ(merge.entries, slow.groups.rbegin()->second.set.size());
    }
    EXPECT_EQ(slow.groups.size(), 1U);
}

TEST(MergeCells, NeverDecreasesTheCostAndEndsInTheUnion) {
    const ViewCells cells = test::random_cells(kSeed, 250);
    const Sets sets = random_sets(250, 100);
    const auto costs = random_numbers(100, 1);
    const auto history = merge_cells(cells, sets, costs);
    double cost = history.leaf_cost();
    for (const CellMerge& merge : history.merges()) {
        EXPECT_GE(merge.cost, cost);
        cost = merge.cost;
    }
    std::vector<ObjectId> all;
    for (const auto& set : sets) {
        all = union_of(all, set);
    }
    EXPECT_NEAR(cost, set_cost(all, costs), 1e-9 * cost);
    EXPECT_EQ(history.merges().back().entries, all.size());
}

TEST(MergeCells, OfEqualPairsTheLowestNumbersFirst) {
    const Sets sets(4, {0});
    const auto history = merge_cells(row_of_four(), sets, std::vector<double>{1.0});
    EXPECT_EQ(history.merges()[0], (CellMerge{0, 1, 1.0, 1}));
    EXPECT_EQ(history.merges()[1], (CellMerge{2, 3, 1.0, 1}));
    EXPECT_EQ(history.merges()[2], (CellMerge{4, 5, 1.0, 1}));
}

TEST(MergeCells, MergesNonAdjacentGroupsLast) {
    // A plane outside of the region leaves one leaf empty, without neighbours; the others differ
    // more from each other than each does from it.
    const Vec3 x(1.0, 0.0, 0.0);
    const ViewCells cells({Vec3(0.0), Vec3(1.0)},
                          {{x, 5.0, 1, kCellLeaf}, {x, 0.5, kCellLeaf + 1, kCellLeaf + 2}},
                          {0.0, 0.5, 0.5});
    const Sets sets = {{}, {0}, {1}};
    const auto history = merge_cells(cells, sets, std::vector<double>{1.0, 1.0});
    EXPECT_EQ(history.merges()[0], (CellMerge{1, 2, 2.0, 2}));
    EXPECT_EQ(history.merges()[1], (CellMerge{0, 3, 2.0, 2}));
}

TEST(MergeCells, IsTheSameForAnyThreads) {
    const ViewCells cells = test::random_cells(kSeed, 250);
    const Sets sets = random_sets(250, 100);
    const auto costs = random_numbers(100, 1);
    const auto history = merge_cells(cells, sets, costs);
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        EXPECT_EQ(history, merge_cells(cells, sets, costs, {}, executor));
    }
}

// A floor at the height of ears, say.
TEST(MergeCells, OfAFlatRegionAreThoseOfAThickOne) {
    const Sets sets = random_sets(20, 30);
    const auto costs = random_numbers(30, 1);
    for (const int axis : {0, 1, 2}) {
        ViewRegion region = {Vec3(0.0), Vec3(20.0)};
        std::array<std::uint32_t, 3> counts = {5, 5, 5};
        counts[static_cast<std::size_t>((axis + 1) % 3)] = 4;
        counts[static_cast<std::size_t>(axis)] = 1;
        const auto thick = merge_cells(ViewCells::grid(region, counts), sets, costs);
        region.lower[axis] = region.upper[axis] = 1.6;
        const auto flat = merge_cells(ViewCells::grid(region, counts), sets, costs);
        ASSERT_EQ(flat.merges().size(), thick.merges().size());
        EXPECT_NEAR(flat.leaf_cost(), thick.leaf_cost(), 1e-12);
        for (std::size_t i = 0; i < flat.merges().size(); ++i) {
            EXPECT_EQ(flat.merges()[i].first, thick.merges()[i].first);
            EXPECT_EQ(flat.merges()[i].second, thick.merges()[i].second);
            EXPECT_NEAR(flat.merges()[i].cost, thick.merges()[i].cost, 1e-12);
        }
    }
}

TEST(MergeCells, OfOneCellIsNothing) {
    const auto history =
        merge_cells(ViewCells({Vec3(0.0), Vec3(1.0)}), Sets{{0}}, std::vector<double>{3.0});
    EXPECT_TRUE(history.merges().empty());
    EXPECT_EQ(history.leaf_cost(), 3.0);
    EXPECT_EQ(history.extract(5), std::vector<CellId>{0});
}

TEST(MergeCells, MergedSetsAreUnionsOverLeaves) {
    const Sets sets = {{0, 1}, {4}, {1, 2}, {}};
    EXPECT_EQ(merged_sets(sets, std::vector<CellId>{0, 1, 0, 2}), (Sets{{0, 1, 2}, {4}, {}}));
}

TEST(MergeCells, RefusesSetsAndCostsOfOtherCells) {
    const std::vector<double> costs = {1.0, 1.0};
    EXPECT_THROW(merge_cells(row_of_four(), Sets(3), costs), Error);
    EXPECT_THROW(merge_cells(row_of_four(), Sets(4), costs, costs), Error);
    EXPECT_THROW(merge_cells(row_of_four(), Sets(4, {2}), costs), Error);
}

}  // namespace
}  // namespace earshot::visibility
