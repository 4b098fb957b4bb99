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

/// Clusters whose nodes are built by one task.
constexpr std::size_t kClustersPerChunk = 512;

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
/// no leaf of 64 primitives lies deeper than kMaxClusterDepth.
constexpr std::uint32_t kMaxCurveDepth = kMaxClusterDepth - 6;

/// Appends the nodes of a cluster to others.
class ClusterTree {
public:
    ClusterTree(std::span<const Aabb> boxes,
                std::span<const MortonPrimitive> sorted,
                std::uint32_t max_leaf_size,
                std::vector<Node>& nodes)
        : boxes_(boxes),
          sorted_(sorted),
          max_leaf_size_(max_leaf_size),
          nodes_(nodes),
          root_(nodes.size()) {
        nodes.emplace_back();
    }

    /// Sets the node, counted from the cluster's root, over a range, and appends what is below it.
    /// Returns its box.
    Aabb write(std::size_t node, std::uint32_t begin, std::uint32_t count, std::uint32_t depth) {
        const std::span<const MortonPrimitive> run = sorted_.subspan(begin, count);
        if (count <= max_leaf_size_) {
            return set(node, {united_box(boxes_, run), begin, count});
        }
        const auto in_left =
            depth < kMaxCurveDepth ? static_cast<std::uint32_t>(curve_split(run)) : count / 2;
        const std::size_t left = nodes_.size() - root_;
        nodes_.resize(nodes_.size() + 2);
        Aabb box = write(left, begin, in_left, depth + 1);
        box.include(write(left + 1, begin + in_left, count - in_left, depth + 1));
        return set(node, {box, static_cast<std::uint32_t>(left), 0});
    }

private:
    Aabb set(std::size_t node, const Node& value) {
        nodes_[root_ + node] = value;
        return value.box;
    }

    std::span<const Aabb> boxes_;
    std::span<const MortonPrimitive> sorted_;
    std::uint32_t max_leaf_size_;
    std::vector<Node>& nodes_;
    std::size_t root_;
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
    clusters_ = find_clusters(boxes, sorted_, options.max_size, executor);
    boxes_.resize(clusters_.size());
    first_node_.resize(clusters_.size());
    node_counts_.resize(clusters_.size());
    nodes_.resize(chunk_count(clusters_.size(), kClustersPerChunk));
    // Boxes lie in memory in another order than on the curve: they are asked for ahead.
    constexpr std::size_t kAhead = 4;
    executor.for_each(clusters_.size(), kClustersPerChunk, [&](std::size_t begin, std::size_t end) {
        std::vector<Node>& nodes = nodes_[begin / kClustersPerChunk];
        nodes.reserve(16 * (end - begin));
        for (std::size_t i = begin; i < end; ++i) {
            if (i + kAhead < end) {
                const MortonRange& next = clusters_[i + kAhead];
                prefetch_boxes(boxes, std::span(sorted_).subspan(next.begin, next.size()));
            }
            first_node_[i] = static_cast<std::uint32_t>(nodes.size());
            boxes_[i] = ClusterTree(boxes, sorted_, options.max_leaf_size, nodes)
                            .write(0, clusters_[i].begin, clusters_[i].size(), 0);
            node_counts_[i] = static_cast<std::uint32_t>(nodes.size()) - first_node_[i];
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
    // The primitives of clusters follow each other as the leaves of `top` do, so that those below
    // any node are neighbours.
    std::vector<std::uint32_t> first_slots(clusters_.size());
    std::uint32_t slots = 0;
    for (const std::uint32_t cluster : top.primitives()) {
        first_slots[cluster] = slots;
        slots += clusters_[cluster].size();
    }
    const auto node_of = [&](std::uint32_t cluster, std::uint32_t i) {
        Node node = nodes_[cluster / kClustersPerChunk][first_node_[cluster] + i];
        if (node.is_leaf()) {
            node.first = first_slots[cluster] + (node.first - clusters_[cluster].begin);
        }
        return node;
    };
    std::vector<Node> nodes =
        TreeAssembly(std::span<const TopNode>(upper), node_counts_, node_of, executor)
            .nodes(executor, 1024);
    return Tree::from_nodes(std::move(nodes), primitives_in(first_slots, executor));
}

std::vector<std::uint32_t> CurveClusters::primitives_in(std::span<const std::uint32_t> first_slots,
                                                        Executor& executor) const {
    auto primitives = vector_on_touched_pages<std::uint32_t>(sorted_.size(), executor);
    executor.for_each(clusters_.size(), kClustersPerChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (std::uint32_t k = 0; k < clusters_[i].size(); ++k) {
                primitives[first_slots[i] + k] = sorted_[clusters_[i].begin + k].index;
            }
        }
    });
    return primitives;
}

}  // namespace earshot::bvh
