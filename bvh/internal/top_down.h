// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/assert.h"
#include "earshot/bvh/internal/assemble.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace earshot::bvh {

/// The primitives [begin, end) of a node, in the builder's order.
struct Range {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t depth = 0;
    std::uint32_t size() const noexcept { return end - begin; }
};

/// Builds a tree from the root by a Splitter that has
///     geometry::Aabb box_of(Range) const;
///     std::uint32_t split(Range, const geometry::Aabb& box, Executor&);
/// `split` reorders a range and returns where its right part begins: at its end, if it becomes a
/// leaf. Large ranges are split one after another with all threads, the others by a task each, so
/// splits of disjoint ranges must not touch each other's data.
template <class Splitter>
class TopDown {
public:
    TopDown(Splitter& splitter, std::uint32_t count, Executor& executor)
        : splitter_(splitter), executor_(executor) {
        split_top(count);
    }

    std::vector<Node> nodes() {
        std::vector<std::vector<Node>> trees(tasks_.size());
        executor_.for_each(tasks_.size(), 1, [&](std::size_t task, std::size_t) {
            trees[task].resize(1);
            build(trees[task], 0, tasks_[task]);
        });
        std::vector<std::uint32_t> counts;
        for (const auto& tree : trees) {
            counts.push_back(static_cast<std::uint32_t>(tree.size()));
        }
        const auto node_of = [&](std::uint32_t task, std::uint32_t i) { return trees[task][i]; };
        return TreeAssembly(std::span<const TopNode>(top_), counts, node_of, executor_)
            .nodes(executor_);
    }

private:
    /// Ranges up to this size are built by one task.
    static constexpr std::uint32_t kTaskSize = 8192;

    void split_top(std::uint32_t count) {
        std::vector<Range> ranges = {{0, count, 0}};
        for (std::size_t i = 0; i < ranges.size(); ++i) {
            const Range range = ranges[i];
            TopNode& node = top_.emplace_back();
            if (range.size() <= kTaskSize) {
                node.task = static_cast<std::uint32_t>(tasks_.size());
                tasks_.push_back(range);
                continue;
            }
            node.box = splitter_.box_of(range);
            const std::uint32_t middle = splitter_.split(range, node.box, executor_);
            node.left = static_cast<std::uint32_t>(ranges.size());
            ranges.push_back({range.begin, middle, range.depth + 1});
            ranges.push_back({middle, range.end, range.depth + 1});
        }
    }

    void build(std::vector<Node>& nodes, std::uint32_t target, const Range& range) {
        EARSHOT_ASSERT(range.depth <= kMaxDepth);
        const geometry::Aabb box = splitter_.box_of(range);
        const std::uint32_t middle = splitter_.split(range, box, Executor::serial());
        nodes[target].box = box;
        if (middle == range.end) {
            nodes[target].first = range.begin;
            nodes[target].count = range.size();
            return;
        }
        const auto left = static_cast<std::uint32_t>(nodes.size());
        nodes.resize(left + 2);
        nodes[target].first = left;
        build(nodes, left, {range.begin, middle, range.depth + 1});
        build(nodes, left + 1, {middle, range.end, range.depth + 1});
    }

    Splitter& splitter_;
    Executor& executor_;
    std::vector<TopNode> top_;
    std::vector<Range> tasks_;
};

}  // namespace earshot::bvh
