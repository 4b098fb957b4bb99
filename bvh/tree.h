// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// No leaf lies deeper; the root has depth 0.
inline constexpr std::size_t kMaxDepth = 64;

/// A node in 32 bytes. The children of an inner node are neighbours in the array.
struct Node {
    geometry::Aabb box;
    std::uint32_t first =
        0;  ///< inner: index of the left child (right follows); leaf: first primitive
    std::uint32_t count = 0;  ///< primitives of a leaf; 0: inner node

    bool is_leaf() const noexcept { return count != 0; }
};

static_assert(sizeof(Node) == 32);

/// How a tree is built. Every builder's tree gives the same answers; they trade build time against
/// query time.
enum class Builder {
    binned_sah,      ///< surface area heuristic over bins (Wald 2007)
    sweep_sah,       ///< SAH over all splits between centroids: the reference, slow to build
    spatial_median,  ///< in the middle of the longest side (Lauterbach 2010): slow to query
    quality,  ///< binned_sah, then reinsertion: 1.5 times the build time, the fastest queries
    lbvh,     ///< along a Morton curve (Lauterbach 2010): quick to build, slower to query
    hybrid,   ///< small clusters along the curve, joined by binned_sah, then reinsertion: for rooms
    fast,     ///< clusters along the curve, joined by binned_sah: the fastest to build
};

struct BuildOptions {
    Builder builder = Builder::binned_sah;
    int max_leaf_size = 4;        ///< primitives in a leaf, 1..15
    double traversal_cost = 1.0;  ///< cost of a node visit, in primitive tests
    /// A sample of the rays that will be traced, as finite segments that end where they hit; some
    /// thousands are plenty. With it binned_sah weighs splits by how many of these rays hit their
    /// sides (Bittner and Havran 2009); other builders ignore it. Read during the build only.
    std::span<const geometry::Segment> rays{};
};

/// A binary hierarchy over boxes that may move. It knows boxes and indices only: triangles, swept
/// triangles and instances are primitives by their boxes.
class Tree {
public:
    Tree() = default;

    /// The tree depends on `boxes` and `options` alone, not on the executor. Throws Error if an
    /// option is out of range or there are 2^31 boxes or more.
    static Tree build(std::span<const geometry::Aabb> boxes,
                      const BuildOptions& options = {},
                      Executor& executor = Executor::serial());

    /// A tree of given nodes. Preconditions: as nodes() and primitives()
    /// promise; every primitive in one leaf; boxes contain what is below them; no deeper than
    /// kMaxDepth.
    static Tree from_nodes(std::vector<Node> nodes, std::vector<std::uint32_t> primitives);

    /// Gives every node its new box, bottom-up; the topology does not change.
    /// Precondition: boxes.size() == primitives().size(). O(n).
    void refit(std::span<const geometry::Aabb> boxes, Executor& executor = Executor::serial());

    /// Nodes in depth-first order, the root first; none if there are no boxes.
    std::span<const Node> nodes() const noexcept { return nodes_; }
    /// Indices into the boxes, leaf after leaf.
    std::span<const std::uint32_t> primitives() const noexcept { return primitives_; }

private:
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> primitives_;
};

/// The box of every triangle, rounded outward.
std::vector<geometry::Aabb> triangle_boxes(const geometry::MeshView& mesh,
                                           Executor& executor = Executor::serial());

}  // namespace earshot::bvh
