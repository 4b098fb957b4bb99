// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/internal/top_down.h"

#include <algorithm>
#include <array>

namespace earshot::bvh {

using geometry::Aabb;

void sweep_costs(std::span<const Aabb> boxes,
                 std::span<const std::uint32_t> order,
                 std::span<double> costs) {
    Aabb box;
    for (std::size_t j = order.size(); j-- > 0;) {
        box.include(boxes[order[j]]);
        costs[j] = static_cast<double>(order.size() - j) * box.half_area();
    }
    box = Aabb::empty();
    for (std::size_t j = 1; j < order.size(); ++j) {
        box.include(boxes[order[j - 1]]);
        costs[j] += static_cast<double>(j) * box.half_area();
    }
}

namespace {

/// Keeps every range sorted along all three axes: sorted once, then partitioned stably.
class SweepSplitter {
public:
    SweepSplitter(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor)
        : boxes_(boxes),
          max_leaf_size_(static_cast<std::uint32_t>(options.max_leaf_size)),
          traversal_cost_(options.traversal_cost),
          goes_left_(boxes.size()) {
        executor.for_each(3, 1, [&](std::size_t axis, std::size_t) {
            costs_[axis].resize(boxes.size());
            scratch_[axis].resize(boxes.size());
            sort_along(axis);
        });
    }

    Aabb box_of(const Range& range) const {
        Aabb box;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            box.include(boxes_[orders_[0][i]]);
        }
        return box;
    }

    std::uint32_t split(const Range& range, const Aabb& box, Executor& executor) {
        if (range.size() == 1 ||
            (range.depth >= kMedianSplitDepth && range.size() <= max_leaf_size_)) {
            return range.end;
        }
        const SweepSplit found = range.depth >= kMedianSplitDepth ? median_split(range, box)
                                                                  : cheapest_split(range, executor);
        if (range.depth < kMedianSplitDepth && range.size() <= max_leaf_size_) {
            const double area = box.half_area();
            const double leaf_cost = static_cast<double>(range.size()) * area;
            if (!(traversal_cost_ * area + found.cost < leaf_cost)) {
                return range.end;
            }
        }
        partition(range, found, executor);
        return range.begin + found.left_count;
    }

    std::vector<std::uint32_t> primitives() && { return std::move(orders_[0]); }

private:
    struct SweepSplit {
        std::size_t axis = 0;
        std::uint32_t left_count = 0;
        double cost = 0.0;
    };

    void sort_along(std::size_t axis) {
        struct Key {
            double doubled_centroid;
            std::uint32_t index;
        };
        std::vector<Key> keys(boxes_.size());
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            const Aabb& box = boxes_[i];
            keys[i] = {static_cast<double>(box.lower[axis]) + static_cast<double>(box.upper[axis]),
                       i};
        }
        std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
            return a.doubled_centroid != b.doubled_centroid
                       ? a.doubled_centroid < b.doubled_centroid
                       : a.index < b.index;
        });
        orders_[axis].reserve(keys.size());
        for (const Key& key : keys) {
            orders_[axis].push_back(key.index);
        }
    }

    /// The cheapest of all splits; of equals the first, axis after axis.
    SweepSplit cheapest_split(const Range& range, Executor& executor) {
        std::array<SweepSplit, 3> splits;
        executor.for_each(3, 1, [&](std::size_t axis, std::size_t) {
            const std::span costs(costs_[axis].data() + range.begin, range.size());
            sweep_costs(boxes_, {orders_[axis].data() + range.begin, range.size()}, costs);
            const auto best = std::min_element(costs.begin() + 1, costs.end());
            splits[axis] = {axis, static_cast<std::uint32_t>(best - costs.begin()), *best};
        });
        return *std::min_element(
            splits.begin(), splits.end(), [](const SweepSplit& a, const SweepSplit& b) {
                return a.cost < b.cost;
            });
    }

    static SweepSplit median_split(const Range& range, const Aabb& box) {
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (box.upper[k] - box.lower[k] > box.upper[axis] - box.lower[axis]) {
                axis = k;
            }
        }
        return {.axis = axis, .left_count = range.size() / 2};
    }

    void partition(const Range& range, const SweepSplit& split, Executor& executor) {
        const std::uint32_t middle = range.begin + split.left_count;
        const std::vector<std::uint32_t>& sorted = orders_[split.axis];
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            goes_left_[sorted[i]] = i < middle ? 1 : 0;
        }
        executor.for_each(3, 1, [&](std::size_t axis, std::size_t) {
            if (axis == split.axis) {
                return;
            }
            std::uint32_t* left = orders_[axis].data() + range.begin;
            std::uint32_t* const scratch = scratch_[axis].data() + range.begin;
            std::uint32_t* right = scratch;
            for (std::uint32_t i = range.begin; i < range.end; ++i) {
                const std::uint32_t index = orders_[axis][i];
                (goes_left_[index] != 0 ? *left++ : *right++) = index;
            }
            std::copy(scratch, right, left);
        });
    }

    std::span<const Aabb> boxes_;
    std::uint32_t max_leaf_size_;
    double traversal_cost_;
    std::array<std::vector<std::uint32_t>, 3> orders_;  // of primitives along each axis
    std::array<std::vector<double>, 3> costs_;
    std::array<std::vector<std::uint32_t>, 3> scratch_;
    std::vector<unsigned char> goes_left_;  // per primitive
};

}  // namespace

// MacDonald and Booth 1990, and Wald 2007, section 2.2: the surface area heuristic over all
// splits between neighbouring centroids, along all axes.
Tree build_sweep_sah(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    SweepSplitter splitter(boxes, options, executor);
    std::vector<Node> nodes =
        TopDown(splitter, static_cast<std::uint32_t>(boxes.size()), executor).nodes();
    return Tree::from_nodes(std::move(nodes), std::move(splitter).primitives());
}

}  // namespace earshot::bvh
