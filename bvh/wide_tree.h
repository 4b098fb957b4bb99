// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

/// Eight boxes side by side, so that a ray meets them in one step.
struct alignas(64) WideNode {
    static constexpr std::size_t kWidth = 8;

    /// Lower x, upper x, lower y, upper y, lower z, upper z of each child; a slot without a child
    /// has the empty box.
    float planes[6][kWidth];
    /// A node's index, or a leaf: see is_leaf(), leaf_place(), leaf_count().
    std::uint32_t child[kWidth];
    /// For each of eight octants of direction, three bits from bit 3 * octant on: lane r names the
    /// child that comes r-th from behind.
    std::uint32_t order[kWidth];
};

static_assert(sizeof(WideNode) == 256);

// A leaf's word: a flag, the number of its triangles less one, and its place.
inline constexpr std::uint32_t kLeafFlag = 0x80000000U;
inline constexpr int kLeafCountShift = 28;
inline constexpr std::size_t kMostInWideLeaf = 8;

/// The word of a slot without a child: the root, which is nobody's child.
inline constexpr std::uint32_t kNoChild = 0;

constexpr bool is_leaf(std::uint32_t child) noexcept {
    return (child & kLeafFlag) != 0;
}
constexpr std::size_t leaf_place(std::uint32_t child) noexcept {
    return child & ((1U << kLeafCountShift) - 1);
}
constexpr std::size_t leaf_count(std::uint32_t child) noexcept {
    return (child >> kLeafCountShift & 7U) + 1;
}

/// How a wide tree keeps the corners of its triangles. The answers are the same.
enum class LeafForm {
    single,     ///< in single precision: about 50 bytes per triangle
    quantised,  ///< in 16 bits, on a grid over the leaf's box: below 40 bytes, and slower
};

/// A hierarchy laid out for rays: nodes of eight children and leaves of up to eight triangles whose
/// corners stand beside them, rounded. Made from a Tree and a mesh, neither of which it keeps;
/// queries need the mesh again, because the decision is made in double precision.
class WideTree {
public:
    WideTree() = default;

    /// Precondition: the tree is over triangle_boxes(mesh). Throws Error if there are 2^28
    /// triangles or more, or a third of that in quantised leaves.
    static WideTree build(const Tree& tree,
                          const geometry::MeshView& mesh,
                          Executor& executor = Executor::serial(),
                          LeafForm leaves = LeafForm::single);

    /// Moves everything to where the mesh's vertices are now, keeping the topology. Same bits for
    /// any executor. O(n). Precondition: the mesh has the triangles that the tree was built over.
    void refit(const geometry::MeshView& mesh, Executor& executor = Executor::serial());

    /// Parents before children, the root first; none if there are no triangles.
    std::span<const WideNode> nodes() const noexcept { return nodes_; }

    /// The leaves, one after another; kPaddingWords follow the last. Of n triangles one
    /// holds nine runs of n coordinates (x, y, z of the first corner, then the second, then the
    /// third), then n triangle indices. Coordinates are floats; in a quantised leaf its first four
    /// words are floats, the lower corner of its box and a step, and coordinates are counts of
    /// steps from there, in 16 bits each.
    std::span<const std::uint32_t> words() const noexcept { return words_; }
    static constexpr std::size_t kPaddingWords = 36;
    LeafForm leaf_form() const noexcept { return leaf_form_; }

    /// Where a leaf begins. Precondition: is_leaf(child).
    const std::uint32_t* leaf_words(std::uint32_t child) const noexcept {
        return words_.data() + words_per_place_ * leaf_place(child);
    }
    /// The triangles of a leaf.
    std::span<const std::uint32_t> leaf_triangles(std::uint32_t child) const noexcept;

    std::size_t triangles() const noexcept { return triangles_; }
    const geometry::Aabb& box() const noexcept { return box_; }
    /// The largest absolute coordinate of the box, metres; 0 without triangles.
    double reach() const noexcept;
    std::size_t bytes() const noexcept;

private:
    friend class PartialRefit;

    /// Sets a node's slots from its children, and from the mesh where they are leaves.
    void refit_node(std::size_t index, const geometry::MeshView& mesh, bool with_leaves);
    void set_box();
    std::uint32_t* leaf_words(std::uint32_t child) noexcept {
        return words_.data() + words_per_place_ * leaf_place(child);
    }

    LargeArray<WideNode> nodes_;
    LargeArray<std::uint32_t> words_;
    LeafForm leaf_form_ = LeafForm::single;
    std::size_t words_per_place_ = 0;
    std::size_t triangles_ = 0;
    geometry::Aabb box_;
};

}  // namespace earshot::bvh
