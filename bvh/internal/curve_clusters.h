// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/bvh/internal/morton.h"
#include "earshot/bvh/tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// The indices of primitives, in their order on the curve.
std::vector<std::uint32_t> indices_of(std::span<const MortonPrimitive> sorted, Executor& executor);

struct CurveClusterOptions {
    std::uint32_t max_size = 64;      ///< primitives in a cluster, at most 64
    std::uint32_t max_leaf_size = 4;  ///< primitives in a leaf
};

/// No leaf lies deeper below a cluster's root.
inline constexpr std::uint32_t kMaxClusterDepth = 11;

/// Runs of primitives along a Morton curve that are close to each other: the largest nodes of a
/// hierarchy along the curve that have few primitives. Below each cluster's root, runs are halved
/// until they fit into leaves.
class CurveClusters {
public:
    CurveClusters(std::span<const geometry::Aabb> boxes,
                  const CurveClusterOptions& options,
                  Executor& executor);

    /// A box per cluster.
    std::span<const geometry::Aabb> boxes() const noexcept { return boxes_; }

    /// The tree with the clusters in place of the leaves of `top`, a tree over boxes() with one of
    /// them to a leaf.
    Tree tree_below(const Tree& top, Executor& executor) const;

private:
    /// The primitives of all clusters, those of each from its first slot on.
    std::vector<std::uint32_t> primitives_in(std::span<const std::uint32_t> first_slots,
                                             Executor& executor) const;

    LargeArray<MortonPrimitive> sorted_;
    std::vector<MortonRange> clusters_;
    std::vector<geometry::Aabb> boxes_;
    std::vector<std::uint32_t> first_node_, node_counts_;  // per cluster
    std::vector<std::vector<Node>> nodes_;  // of chunks of clusters: depth-first, child indices
                                            // from a cluster's root
};

}  // namespace earshot::bvh
