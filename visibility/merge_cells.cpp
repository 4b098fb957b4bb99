// SPDX-License-Identifier: MIT
#include "earshot/visibility/merge_cells.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/visibility/internal/cell_adjacency.h"
#include "earshot/visibility/render_cost.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

namespace earshot::visibility {

using geometry::Vec3;

namespace {

constexpr std::size_t kPairsPerChunk = 64;

/// The costs of the objects that only one of two ascending sets holds.
struct Difference {
    double only_a = 0.0, only_b = 0.0;
};

Difference difference(std::span<const ObjectId> a,
                      std::span<const ObjectId> b,
                      std::span<const double> costs) noexcept {
    Difference result;
    std::size_t i = 0;
    std::size_t k = 0;
    while (i < a.size() && k < b.size()) {
        if (a[i] == b[k]) {
            ++i;
            ++k;
        } else if (a[i] < b[k]) {
            result.only_a += costs[a[i++]];
        } else {
            result.only_b += costs[b[k++]];
        }
    }
    result.only_a += set_cost(a.subspan(i), costs);
    result.only_b += set_cost(b.subspan(k), costs);
    return result;
}

struct Group {
    double viewer_fraction = 0.0;
    std::vector<ObjectId> set{};
    std::vector<std::uint32_t> neighbours{};  // ascending
    bool is_alive = true;
};

/// Two adjacent groups that may be merged: the smallest cost increase first, of equals the lowest
/// numbers. The increase of two groups does not change while both exist, so that an entry is either
/// right or stale.
struct MergeCandidate {
    double cost_increase = 0.0;
    std::uint32_t first = 0, second = 0;
    bool operator<(const MergeCandidate& other) const {
        return std::tie(cost_increase, first, second) >
               std::tie(other.cost_increase, other.first, other.second);
    }
};

class Merger {
public:
    Merger(const ViewCells& cells,
           std::span<const std::vector<ObjectId>> sets,
           std::span<const double> costs,
           Executor& executor)
        : costs_(costs), executor_(executor), groups_(cells.leaves()) {
        for (std::size_t i = 0; i < groups_.size(); ++i) {
            groups_[i].set = sets[i];
        }
        std::vector<MergeCandidate> pairs;
        for (const CellAdjacency& adjacency : cell_adjacencies(cells)) {
            groups_[adjacency.first].neighbours.push_back(adjacency.second);
            groups_[adjacency.second].neighbours.push_back(adjacency.first);
            pairs.push_back({0.0, adjacency.first, adjacency.second});
        }
        for (Group& group : groups_) {
            std::sort(group.neighbours.begin(), group.neighbours.end());
        }
        initial_ = std::move(pairs);
    }

    MergeHistory run(std::span<const double> viewer_fractions);

private:
    /// The increase of the average cost by merging two groups, each of which gets the objects of
    /// the other. Never negative, and 0 for equal sets.
    double cost_increase(std::uint32_t a, std::uint32_t b) const noexcept {
        const Difference extra = difference(groups_[a].set, groups_[b].set, costs_);
        return groups_[a].viewer_fraction * extra.only_b +
               groups_[b].viewer_fraction * extra.only_a;
    }

    void add(std::vector<MergeCandidate> pairs) {
        executor_.for_each(pairs.size(), kPairsPerChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                pairs[i].cost_increase = cost_increase(pairs[i].first, pairs[i].second);
            }
        });
        for (const MergeCandidate& pair : pairs) {
            queue_.push(pair);
        }
    }

    void merge(const MergeCandidate& pair);

    std::span<const double> costs_;
    Executor& executor_;
    std::vector<Group> groups_;
    std::vector<MergeCandidate> initial_;
    std::priority_queue<MergeCandidate> queue_;
    double cost_ = 0.0;
    std::vector<CellMerge> merges_;
};

void Merger::merge(const MergeCandidate& pair) {
    const auto number = static_cast<std::uint32_t>(groups_.size());
    Group& a = groups_[pair.first];
    Group& b = groups_[pair.second];
    Group both{a.viewer_fraction + b.viewer_fraction, union_of(a.set, b.set)};
    std::set_union(a.neighbours.begin(),
                   a.neighbours.end(),
                   b.neighbours.begin(),
                   b.neighbours.end(),
                   std::back_inserter(both.neighbours));
    std::erase_if(both.neighbours, [&](std::uint32_t neighbour) {
        return neighbour == pair.first || neighbour == pair.second;
    });
    a = {0.0, {}, {}, false};
    b = {0.0, {}, {}, false};
    cost_ += pair.cost_increase;
    merges_.push_back({pair.first, pair.second, cost_, both.set.size()});
    std::vector<MergeCandidate> pairs;
    for (const std::uint32_t neighbour : both.neighbours) {
        auto& others = groups_[neighbour].neighbours;
        std::erase_if(others, [&](std::uint32_t other) {
            return other == pair.first || other == pair.second;
        });
        others.push_back(number);
        pairs.push_back({0.0, neighbour, number});
    }
    groups_.push_back(std::move(both));
    add(std::move(pairs));
}

MergeHistory Merger::run(std::span<const double> viewer_fractions) {
    const std::size_t leaves = groups_.size();
    std::vector<std::uint64_t> entries(leaves);
    for (std::size_t i = 0; i < leaves; ++i) {
        groups_[i].viewer_fraction = viewer_fractions[i];
        entries[i] = groups_[i].set.size();
        cost_ += viewer_fractions[i] * set_cost(groups_[i].set, costs_);
    }
    const double leaf_cost = cost_;
    add(std::move(initial_));
    while (!queue_.empty()) {
        const MergeCandidate next = queue_.top();
        queue_.pop();
        if (groups_[next.first].is_alive && groups_[next.second].is_alive) {
            merge(next);
        }
    }
    // The groups that are left are not adjacent to any other.
    std::vector<std::uint32_t> isolated;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        if (groups_[i].is_alive) {
            isolated.push_back(static_cast<std::uint32_t>(i));
        }
    }
    for (std::size_t i = 1; i < isolated.size(); ++i) {
        const auto last = i == 1 ? isolated[0] : static_cast<std::uint32_t>(groups_.size() - 1);
        const auto [first, second] = std::minmax(last, isolated[i]);
        merge({cost_increase(first, second), first, second});
    }
    return {leaf_cost, std::move(entries), std::move(merges_)};
}

/// The cells of a flat region extruded to some thickness, so that leaves share faces, not only
/// edges.
ViewCells thickened(const ViewCells& cells) {
    ViewRegion region = cells.region();
    const Vec3 size = region.size();
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] == 0.0) {
            region.lower[axis] -= 0.5 * glm::length(size);
            region.upper[axis] += 0.5 * glm::length(size);
        }
    }
    return {region,
            {cells.nodes().begin(), cells.nodes().end()},
            {cells.leaf_volumes().begin(), cells.leaf_volumes().end()}};
}

[[noreturn]] void fail(const char* what) {
    throw Error("merging cells", what, "give what belongs to these cells");
}

}  // namespace

MergeHistory merge_cells(const ViewCells& cells,
                         std::span<const std::vector<ObjectId>> sets,
                         std::span<const double> costs,
                         std::span<const double> viewer_fractions,
                         Executor& executor) {
    if (sets.size() != cells.leaves() ||
        (!viewer_fractions.empty() && viewer_fractions.size() != cells.leaves())) {
        fail("there is not one set and viewer fraction per leaf");
    }
    for (const auto& set : sets) {
        if (!set.empty() && set.back() >= costs.size()) {
            fail("an object has no cost");
        }
    }
    std::vector<double> by_volume(cells.leaf_volumes().begin(), cells.leaf_volumes().end());
    const double volume = std::accumulate(by_volume.begin(), by_volume.end(), 0.0);
    for (double& fraction : by_volume) {
        // A flat region is divided as if it were a little thick.
        fraction = volume > 0.0 ? fraction / volume : 1.0 / static_cast<double>(by_volume.size());
    }
    return Merger(volume > 0.0 ? cells : thickened(cells), sets, costs, executor)
        .run(viewer_fractions.empty() ? by_volume : viewer_fractions);
}

std::vector<std::vector<ObjectId>> merged_sets(std::span<const std::vector<ObjectId>> sets,
                                               std::span<const CellId> cell_of_leaf) {
    EARSHOT_ASSERT(sets.size() == cell_of_leaf.size());
    std::vector<std::vector<ObjectId>> merged;
    for (std::size_t i = 0; i < sets.size(); ++i) {
        if (cell_of_leaf[i] >= merged.size()) {
            merged.resize(std::size_t{cell_of_leaf[i]} + 1);
        }
        auto& set = merged[cell_of_leaf[i]];
        set.insert(set.end(), sets[i].begin(), sets[i].end());
    }
    for (auto& set : merged) {
        std::sort(set.begin(), set.end());
        set.erase(std::unique(set.begin(), set.end()), set.end());
    }
    return merged;
}

}  // namespace earshot::visibility
