// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/curve_clusters.h"

#include "earshot/bvh/internal/assemble.h"
#include "earshot/bvh/internal/boxes_kernel.h"

#include <algorithm>
#include <utility>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::size_t kGrain = 16384;

/// Ranges of the curve up to this size are divided into clusters by one task.
constexpr std::uint32_t kTaskSize = 16384;

/// Divides a range at the splits of the curve until no part is larger than `max_size`; the parts
/// are appended in their order.
void divide(std::span<const Aabb> boxes,
            std::span<MortonPrimitive> sorted,
            const MortonRange& all,
            std::uint32_t max_size,
            Executor& executor,
            std::vector<MortonRange>& parts) {
    std::vector<MortonRange> stack = {all};
    while (!stack.empty()) {
        MortonRange range = stack.back();
        stack.pop_back();
        if (range.size() <= max_size) {
            parts.push_back(range);
            continue;
        }
        const std::uint32_t middle = split_morton_range(boxes, sorted, range, executor);
        stack.push_back({middle, range.end, range.is_one_point});
        stack.push_back({range.begin, middle, range.is_one_point});
    }
}

std::vector<MortonRange> find_clusters(std::span<const Aabb> boxes,
                                       std::span<MortonPrimitive> sorted,
                                       std::uint32_t max_size,
                                       Executor& executor) {
    std::vector<MortonRange> tasks;
    divide(boxes,
           sorted,
           {0, static_cast<std::uint32_t>(sorted.size())},
           std::max(kTaskSize, max_size),
           executor,
           tasks);
    std::vector<std::vector<MortonRange>> of_tasks(tasks.size());
    executor.for_each(tasks.size(), 1, [&](std::size_t task, std::size_t) {
        of_tasks[task].reserve(tasks[task].size() / (max_size / 2) + 1);
        divide(boxes, sorted, tasks[task], max_size, Executor::serial(), of_tasks[task]);
    });
    std::vector<MortonRange> clusters;
    clusters.reserve(sorted.size() / (max_size / 2) + 1);
    for (const auto& of_task : of_tasks) {
        clusters.insert(clusters.end(), of_task.begin(), of_task.end());
    }
    return clusters;
}

/// Splits at the curve down to this depth below a cluster's root, and in the middle below, so that
/// no leaf of sixteen primitives lies deeper than kMaxClusterDepth.
constexpr std::uint32_t kMaxCurveDepth = kMaxClusterDepth - 4;

/// The nodes of a cluster.
class ClusterTree {
public:
    ClusterTree(std::span<const MortonPrimitive> sorted, std::uint32_t max_leaf_size)
        : sorted_(sorted), max_leaf_size_(max_leaf_size) {}

    /// How many nodes there are over a range.
    std::uint32_t node_count(std::uint32_t begin, std::uint32_t count, std::uint32_t depth) const {
        if (count <= max_leaf_size_) {
            return 1;
        }
        const std::uint32_t left = left_count(begin, count, depth);
        return 1 + node_count(begin, left, depth + 1) +
               node_count(begin + left, count - left, depth + 1);
    }

    /// Sets nodes[target], the root over a range, and appends what is below it.
    void write(std::span<const Aabb> boxes,
               Node* nodes,
               std::uint32_t target,
               std::uint32_t begin,
               std::uint32_t count,
               std::uint32_t depth) {
        Node& node = nodes[target];
        if (count <= max_leaf_size_) {
            node = {united_box(boxes, sorted_.subspan(begin, count)), begin, count};
            return;
        }
        const std::uint32_t left = next_;
        const std::uint32_t in_left = left_count(begin, count, depth);
        next_ += 2;
        write(boxes, nodes, left, begin, in_left, depth + 1);
        write(boxes, nodes, left + 1, begin + in_left, count - in_left, depth + 1);
        node = {nodes[left].box, left, 0};
        node.box.include(nodes[left + 1].box);
    }

private:
    std::uint32_t left_count(std::uint32_t begin, std::uint32_t count, std::uint32_t depth) const {
        return depth < kMaxCurveDepth
                   ? static_cast<std::uint32_t>(curve_split(sorted_.subspan(begin, count)))
                   : count / 2;
    }

    std::span<const MortonPrimitive> sorted_;
    std::uint32_t max_leaf_size_;
    std::uint32_t next_ = 1;
};

void prefetch_boxes(std::span<const Aabb> boxes, std::span<const MortonPrimitive> run) {
    for (const MortonPrimitive& primitive : run) {
        __builtin_prefetch(&boxes[primitive.index]);
    }
}

}  // namespace

std::vector<std::uint32_t> indices_of(std::span<const MortonPrimitive> sorted, Executor& executor) {
    std::vector<std::uint32_t> indices(sorted.size());
    executor.for_each(sorted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            indices[i] = sorted[i].index;
        }
    });
    return indices;
}

CurveClusters::CurveClusters(std::span<const Aabb> boxes,
                             const CurveClusterOptions& options,
                             Executor& executor)
    : sorted_(sorted_by_morton_code(boxes, executor)) {
    const std::vector<MortonRange> clusters =
        find_clusters(boxes, sorted_, options.max_size, executor);
    boxes_.resize(clusters.size());
    first_node_.resize(clusters.size());
    node_counts_.resize(clusters.size());
    std::uint32_t node_count = 0;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
        first_node_[i] = node_count;
        node_counts_[i] = ClusterTree(sorted_, options.max_leaf_size)
                              .node_count(clusters[i].begin, clusters[i].size(), 0);
        node_count += node_counts_[i];
    }
    nodes_.resize(node_count);
    // Boxes lie in memory in another order than on the curve: they are asked for ahead.
    constexpr std::size_t kAhead = 4;
    executor.for_each(clusters.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i + kAhead < end) {
                const MortonRange& next = clusters[i + kAhead];
                prefetch_boxes(boxes, std::span(sorted_).subspan(next.begin, next.size()));
            }
            Node* const nodes = &nodes_[first_node_[i]];
            ClusterTree(sorted_, options.max_leaf_size)
                .write(boxes, nodes, 0, clusters[i].begin, clusters[i].size(), 0);
            boxes_[i] = nodes[0].box;
        }
    });
}

Tree CurveClusters::tree_below(const Tree& top, Executor& executor) const {
    std::vector<TopNode> upper(top.nodes().size());
    executor.for_each(upper.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Node& node = top.nodes()[i];
            upper[i] = node.is_leaf()
                           ? TopNode{.box = {}, .left = 0, .task = top.primitives()[node.first]}
                           : TopNode{.box = node.box, .left = node.first, .task = 0};
        }
    });
    const auto node_of = [&](std::uint32_t cluster, std::uint32_t i) {
        return nodes_[first_node_[cluster] + i];
    };
    std::vector<Node> nodes =
        TreeAssembly(std::span<const TopNode>(upper), node_counts_, node_of).nodes(executor, 1024);
    return Tree::from_nodes(std::move(nodes), indices_of(sorted_, executor));
}

}  // namespace earshot::bvh
