// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/internal/morton.h"
#include "earshot/bvh/internal/top_down.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

std::vector<std::uint32_t> indices_of(std::span<const MortonPrimitive> sorted) {
    std::vector<std::uint32_t> indices;
    indices.reserve(sorted.size());
    for (const MortonPrimitive& primitive : sorted) {
        indices.push_back(primitive.index);
    }
    return indices;
}

/// Splits ranges of the curve at the highest bit that differs. A refit sets the boxes afterwards.
class MortonSplitter {
public:
    MortonSplitter(std::span<const MortonPrimitive> sorted, const BuildOptions& options)
        : sorted_(sorted), max_leaf_size_(static_cast<std::uint32_t>(options.max_leaf_size)) {}

    static Aabb box_of(const Range&) { return {}; }

    std::uint32_t split(const Range& range, const Aabb&, Executor&) const {
        if (range.size() <= max_leaf_size_) {
            return range.end;
        }
        // From here on median splits end before kMaxDepth, whatever the codes are.
        constexpr std::uint32_t kMedianSplitDepth = kMaxDepth - 32;
        return range.depth >= kMedianSplitDepth
                   ? range.begin + range.size() / 2
                   : find_morton_split(sorted_, range.begin, range.end);
    }

private:
    std::span<const MortonPrimitive> sorted_;
    std::uint32_t max_leaf_size_;
};

}  // namespace

Tree build_lbvh(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    const auto sorted = sorted_by_morton_code(boxes, executor);
    MortonSplitter splitter(sorted, options);
    std::vector<Node> nodes =
        TopDown(splitter, static_cast<std::uint32_t>(boxes.size()), executor).nodes();
    Tree tree = Tree::from_nodes(std::move(nodes), indices_of(sorted));
    tree.refit(boxes, executor);
    return tree;
}

Tree build_hybrid(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    constexpr std::uint32_t kLevels = 6;  // Lauterbach 2010, section 5.3
    const auto sorted = sorted_by_morton_code(boxes, executor);
    std::vector<TopNode> top;
    std::vector<Range> ranges = {{0, static_cast<std::uint32_t>(boxes.size()), 0}};
    std::vector<Range> tasks;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const Range range = ranges[i];
        TopNode& node = top.emplace_back();
        if (range.size() == 1 || range.depth >= kLevels) {
            node.task = static_cast<std::uint32_t>(tasks.size());
            tasks.push_back(range);
            continue;
        }
        node.left = static_cast<std::uint32_t>(ranges.size());
        const std::uint32_t middle = find_morton_split(sorted, range.begin, range.end);
        ranges.push_back({range.begin, middle, range.depth + 1});
        ranges.push_back({middle, range.end, range.depth + 1});
    }
    std::vector<Tree> trees(tasks.size());
    std::vector<std::uint32_t> primitives(boxes.size());
    executor.for_each(tasks.size(), 1, [&](std::size_t task, std::size_t) {
        const Range& range = tasks[task];
        std::vector<Aabb> task_boxes;
        task_boxes.reserve(range.size());
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            task_boxes.push_back(boxes[sorted[i].index]);
        }
        trees[task] = build_binned_sah(task_boxes, options, Executor::serial());
        const auto order = trees[task].primitives();
        std::transform(
            order.begin(), order.end(), primitives.begin() + range.begin, [&](std::uint32_t i) {
                return sorted[range.begin + i].index;
            });
    });
    std::vector<std::uint32_t> counts;
    for (const Tree& tree : trees) {
        counts.push_back(static_cast<std::uint32_t>(tree.nodes().size()));
    }
    const auto node_of = [&](std::uint32_t task, std::uint32_t i) {
        Node node = trees[task].nodes()[i];
        node.first += node.is_leaf() ? tasks[task].begin : 0;
        return node;
    };
    std::vector<Node> nodes =
        TreeAssembly(std::span<const TopNode>(top), counts, node_of).nodes(executor);
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (!nodes[i].is_leaf()) {
            nodes[i].box = nodes[nodes[i].first].box;
            nodes[i].box.include(nodes[nodes[i].first + 1].box);
        }
    }
    Tree tree = Tree::from_nodes(std::move(nodes), std::move(primitives));
    // The subtrees count their depth from their own roots, so the sum may be too deep.
    return quality(tree).depth <= kMaxDepth ? tree : build_binned_sah(boxes, options, executor);
}

Tree build_fast(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    // The curve leaves a few large boxes, which three batches find.
    constexpr ReinsertionOptions kReinsertion = {.max_iterations = 3, .batch_size_ratio = 0.005};
    Tree tree = build_lbvh(boxes, options, executor);
    optimise_by_reinsertion(tree, kReinsertion, executor);
    return tree;
}

}  // namespace earshot::bvh
