// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/internal/curve_clusters.h"
#include "earshot/bvh/internal/morton.h"
#include "earshot/bvh/internal/top_down.h"
#include "earshot/bvh/reinsertion.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

/// Splits ranges of the curve at the highest bit that differs. A refit sets the boxes afterwards.
class MortonSplitter {
public:
    MortonSplitter(std::span<const Aabb> boxes,
                   std::span<MortonPrimitive> sorted,
                   const BuildOptions& options)
        : boxes_(boxes),
          sorted_(sorted),
          max_leaf_size_(static_cast<std::uint32_t>(options.max_leaf_size)) {}

    static Aabb box_of(const Range&) { return {}; }

    std::uint32_t split(const Range& range, const Aabb&, Executor& executor) const {
        if (range.size() <= max_leaf_size_) {
            return range.end;
        }
        // From here on median splits end before kMaxDepth, whatever the codes are.
        if (range.depth >= kMedianSplitDepth) {
            return range.begin + range.size() / 2;
        }
        MortonRange on_curve = {range.begin, range.end};
        return split_morton_range(boxes_, sorted_, on_curve, executor);
    }

private:
    std::span<const Aabb> boxes_;
    std::span<MortonPrimitive> sorted_;
    std::uint32_t max_leaf_size_;
};

/// Clusters of at most so many primitives along the curve, joined by binned SAH (Garanzha,
/// Pantaleoni and McAllister 2011).
Tree build_clustered(std::span<const Aabb> boxes,
                     std::uint32_t max_cluster_size,
                     const BuildOptions& options,
                     Executor& executor) {
    const CurveClusters clusters(
        boxes,
        {.max_size = max_cluster_size,
         .max_leaf_size = static_cast<std::uint32_t>(options.max_leaf_size)},
        executor);
    // Binned SAH splits at the median from kMedianSplitDepth on.
    constexpr std::size_t kMaxClusters = std::size_t{1}
                                         << (kMaxDepth - kMedianSplitDepth - kMaxClusterDepth);
    if (clusters.boxes().size() > kMaxClusters) {
        return build_binned_sah(boxes, options, executor);
    }
    const Tree top = build_binned_sah(
        clusters.boxes(), {.max_leaf_size = 1, .traversal_cost = options.traversal_cost}, executor);
    return clusters.tree_below(top, executor);
}

}  // namespace

Tree build_lbvh(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    auto sorted = sorted_by_morton_code(boxes, executor);
    MortonSplitter splitter(boxes, sorted, options);
    std::vector<Node> nodes =
        TopDown(splitter, static_cast<std::uint32_t>(boxes.size()), executor).nodes();
    Tree tree = Tree::from_nodes(std::move(nodes), indices_of(sorted, executor));
    tree.refit(boxes, executor);
    return tree;
}

Tree build_hybrid(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    constexpr std::uint32_t kMaxClusterSize = 4;
    constexpr ReinsertionOptions kReinsertion = {.max_iterations = 3, .batch_size_ratio = 0.005};
    Tree tree = build_clustered(boxes, kMaxClusterSize, options, executor);
    optimise_by_reinsertion(tree, kReinsertion, executor);
    return tree;
}

Tree build_fast(std::span<const Aabb> boxes, const BuildOptions& options, Executor& executor) {
    // Where the boxes do not fit into the caches, memory takes the time, and better splits cost
    // little.
    constexpr std::size_t kMinManyBoxes = std::size_t{1} << 18;
    const std::uint32_t max_cluster_size = boxes.size() < kMinManyBoxes ? 64 : 16;
    return build_clustered(boxes, max_cluster_size, options, executor);
}

}  // namespace earshot::bvh
