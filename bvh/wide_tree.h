// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/bvh/exact_coordinates.h"
#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

class CoordinateRules;

/// A node with the boxes of up to eight children side by side, so that a ray is tested against all
/// of them at once.
struct alignas(64) WideNode {
    static constexpr std::size_t kWidth = 8;

    /// Lower x, upper x, lower y, upper y, lower z, upper z of each child; a slot without a child
    /// has the empty box.
    float planes[6][kWidth];
    /// The index of a node, or a leaf: see is_leaf(), leaf_block(), leaf_count().
    std::uint32_t child[kWidth];
    /// Traversal order by octant of direction, three bits each from bit 3 * octant on: order[r]
    /// holds the slot of the r-th farthest child.
    std::uint32_t order[kWidth];
};

static_assert(sizeof(WideNode) == 256);

// A leaf as a child: a flag, the number of its triangles less one, and its first block.
inline constexpr std::uint32_t kLeafFlag = 0x80000000U;
inline constexpr int kLeafCountShift = 28;
inline constexpr std::size_t kMaxLeafTriangles = 8;

/// A slot without a child: the index of the root, which is no node's child.
inline constexpr std::uint32_t kNoChild = 0;

constexpr bool is_leaf(std::uint32_t child) noexcept {
    return (child & kLeafFlag) != 0;
}
constexpr std::size_t leaf_block(std::uint32_t child) noexcept {
    return child & ((1U << kLeafCountShift) - 1);
}
constexpr std::size_t leaf_count(std::uint32_t child) noexcept {
    return (child >> kLeafCountShift & 7U) + 1;
}

/// The box of a slot; empty if the slot has no child.
inline geometry::Aabb slot_box(const WideNode& node, std::size_t slot) noexcept {
    geometry::Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] = node.planes[2 * axis][slot];
        box.upper[axis] = node.planes[2 * axis + 1][slot];
    }
    return box;
}

/// How a wide tree stores the vertices of its triangles. The answers are the same.
enum class LeafEncoding {
    single,     ///< in single precision: about 50 bytes per triangle
    quantised,  ///< in 16 bits on a grid over the leaf's box: below 40 bytes, and slower
};

/// A hierarchy laid out for rays: nodes of eight children, and packed leaves with the vertices of
/// up to eight triangles, rounded. Made from a Tree and a mesh, neither of which it keeps; queries
/// need the mesh again, because hits are decided in double precision.
class WideTree {
public:
    WideTree() = default;

    /// Precondition: the tree is over triangle_boxes(mesh). Throws Error if there are 2^28
    /// triangles or more, or a third of that in quantised leaves.
    static WideTree build(const Tree& tree,
                          const geometry::MeshView& mesh,
                          Executor& executor = Executor::serial(),
                          LeafEncoding encoding = LeafEncoding::single);

    /// Moves everything to where the mesh's vertices are now, keeping the topology. Same bits for
    /// any executor. O(n). Precondition: the mesh has the triangles that the tree was built over.
    void refit(const geometry::MeshView& mesh, Executor& executor = Executor::serial());

    /// Parents before children, the root first; none if there are no triangles.
    std::span<const WideNode> nodes() const noexcept { return nodes_; }

    /// The packed leaves, one after another; kPaddingWords follow the last. A leaf of n triangles
    /// holds nine arrays of n coordinates (x, y, z of the first vertices, then of the second, then
    /// of the third), then n triangle indices. Coordinates are floats. A quantised leaf begins with
    /// its quantisation frame, four floats: the lower corner of its box and a step; coordinates are
    /// counts of steps from there, in 16 bits each.
    std::span<const std::uint32_t> packed_leaves() const noexcept { return words_; }
    static constexpr std::size_t kPaddingWords = 36;
    LeafEncoding leaf_encoding() const noexcept { return leaf_encoding_; }
    /// How the vertices follow from the packed leaves; not known if these are quantised.
    const ExactCoordinates& exact_coordinates() const noexcept { return exact_coordinates_; }

    /// The first word of a packed leaf. Precondition: is_leaf(child).
    const std::uint32_t* packed_leaf(std::uint32_t child) const noexcept {
        return words_.data() + words_per_block_ * leaf_block(child);
    }
    /// The triangles of a leaf.
    std::span<const std::uint32_t> leaf_triangles(std::uint32_t child) const noexcept;

    std::size_t triangle_count() const noexcept { return triangle_count_; }
    const geometry::Aabb& box() const noexcept { return box_; }
    /// The largest absolute coordinate of the box, metres; 0 without triangles.
    double max_abs_coordinate() const noexcept { return max_abs_coordinate_; }
    std::size_t bytes() const noexcept;

private:
    friend class PartialRefit;

    /// Sets the boxes of a node's slots from its children: nodes, and leaves if `with_leaves`,
    /// which are packed again from the mesh and checked.
    void refit_node(std::size_t index,
                    const geometry::MeshView& mesh,
                    bool with_leaves,
                    CoordinateRules& rules);
    void set_box(const geometry::Aabb& box) noexcept;
    std::uint32_t* packed_leaf(std::uint32_t child) noexcept {
        return words_.data() + words_per_block_ * leaf_block(child);
    }

    LargeArray<WideNode> nodes_;
    LargeArray<std::uint32_t> words_;
    LeafEncoding leaf_encoding_ = LeafEncoding::single;
    std::size_t words_per_block_ = 0;
    ExactCoordinates exact_coordinates_;
    std::size_t triangle_count_ = 0;
    geometry::Aabb box_;
    double max_abs_coordinate_ = 0.0;
};

}  // namespace earshot::bvh
