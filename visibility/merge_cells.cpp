// SPDX-License-Identifier: MIT
#include "earshot/visibility/merge_cells.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/visibility/internal/leaf_contacts.h"
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

/// The costs of what only one of two ascending sets holds.
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
    double share = 0.0;
    std::vector<ObjectId> set{};
    std::vector<std::uint32_t> neighbours{};  // ascending
    bool is_there = true;
};

/// Two neighbours that may be merged: the smallest rise first, of equals the lowest numbers. What
/// merging two groups adds does not change while both are there, so that an entry is either right
/// or about a group that is gone.
struct Candidate {
    double rise = 0.0;
    std::uint32_t first = 0, second = 0;
    bool operator<(const Candidate& other) const {
        return std::tie(rise, first, second) > std::tie(other.rise, other.first, other.second);
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
        std::vector<Candidate> pairs;
        for (const LeafContact& contact : leaf_contacts(cells)) {
            groups_[contact.first].neighbours.push_back(contact.second);
            groups_[contact.second].neighbours.push_back(contact.first);
            pairs.push_back({0.0, contact.first, contact.second});
        }
        for (Group& group : groups_) {
            std::sort(group.neighbours.begin(), group.neighbours.end());
        }
        initial_ = std::move(pairs);
    }

    MergeHistory run(std::span<const double> viewer_fractions);

private:
    /// What the average cost rises by when two groups become one: each sees what only the other
    /// saw. Never negative, and 0 for equal sets.
    double rise(std::uint32_t a, std::uint32_t b) const noexcept {
        const Difference extra = difference(groups_[a].set, groups_[b].set, costs_);
        return groups_[a].share * extra.only_b + groups_[b].share * extra.only_a;
    }

    void add(std::vector<Candidate> pairs) {
        executor_.for_each(pairs.size(), kPairsPerChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                pairs[i].rise = rise(pairs[i].first, pairs[i].second);
            }
        });
        for (const Candidate& pair : pairs) {
            waiting_.push(pair);
        }
    }

    void merge(const Candidate& pair);

    std::span<const double> costs_;
    Executor& executor_;
    std::vector<Group> groups_;
    std::vector<Candidate> initial_;
    std::priority_queue<Candidate> waiting_;
    double cost_ = 0.0;
    std::vector<CellMerge> merges_;
};

void Merger::merge(const Candidate& pair) {
    const auto number = static_cast<std::uint32_t>(groups_.size());
    Group& a = groups_[pair.first];
    Group& b = groups_[pair.second];
    Group both{a.share + b.share, union_of(a.set, b.set)};
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
    cost_ += pair.rise;
    merges_.push_back({pair.first, pair.second, cost_, both.set.size()});
    std::vector<Candidate> pairs;
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
        groups_[i].share = viewer_fractions[i];
        entries[i] = groups_[i].set.size();
        cost_ += viewer_fractions[i] * set_cost(groups_[i].set, costs_);
    }
    const double leaf_cost = cost_;
    add(std::move(initial_));
    while (!waiting_.empty()) {
        const Candidate next = waiting_.top();
        waiting_.pop();
        if (groups_[next.first].is_there && groups_[next.second].is_there) {
            merge(next);
        }
    }
    // What is left has no neighbours.
    std::vector<std::uint32_t> apart;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        if (groups_[i].is_there) {
            apart.push_back(static_cast<std::uint32_t>(i));
        }
    }
    for (std::size_t i = 1; i < apart.size(); ++i) {
        const auto last = i == 1 ? apart[0] : static_cast<std::uint32_t>(groups_.size() - 1);
        const auto [first, second] = std::minmax(last, apart[i]);
        merge({rise(first, second), first, second});
    }
    return {leaf_cost, std::move(entries), std::move(merges_)};
}

/// A flat region's cells at some thickness: leaves touch in faces then, not only in edges.
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
        fail("there is not one set and share per leaf");
    }
    for (const auto& set : sets) {
        if (!set.empty() && set.back() >= costs.size()) {
            fail("an object has no cost");
        }
    }
    std::vector<double> by_volume(cells.leaf_volumes().begin(), cells.leaf_volumes().end());
    const double volume = std::accumulate(by_volume.begin(), by_volume.end(), 0.0);
    for (double& share : by_volume) {
        // A flat region is divided as if it were a little thick.
        share = volume > 0.0 ? share / volume : 1.0 / static_cast<double>(by_volume.size());
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
