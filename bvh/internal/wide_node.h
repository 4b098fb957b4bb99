// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

// Writing the nodes and packed leaves of a WideTree.

/// Sets the box of a slot.
void set_slot_box(WideNode& node, std::size_t slot, const geometry::Aabb& box) noexcept;

/// The union of the boxes of all slots.
geometry::Aabb box_of(const WideNode& node) noexcept;

/// Sets the boxes of all slots to those of nodes, and the traversal orders from them: the slots
/// sorted along the eight diagonals.
void set_boxes_and_order(WideNode& node, const Node* const (&boxes)[WideNode::kWidth]) noexcept;

// Prefetch what pack_leaf() will read: first the triangles, and when these are in the cache, their
// vertices.
inline void prefetch_triangles(std::span<const std::uint32_t> triangles,
                               const geometry::MeshView& mesh) noexcept {
    for (const std::uint32_t triangle : triangles) {
        __builtin_prefetch(&mesh.triangles[triangle]);
    }
}
inline void prefetch_vertices(std::span<const std::uint32_t> triangles,
                              const geometry::MeshView& mesh) noexcept {
    for (const std::uint32_t triangle : triangles) {
        for (const geometry::VertexId vertex : mesh.triangles[triangle]) {
            __builtin_prefetch(&mesh.positions[vertex]);
        }
    }
}

/// Words of the quantisation frame that a quantised leaf begins with.
inline constexpr std::size_t kQuantisationFrameWords = 4;

/// The first word of the triangle indices in a packed leaf of `count` triangles.
constexpr std::size_t triangle_ids_offset(LeafEncoding encoding, std::size_t count) noexcept {
    return encoding == LeafEncoding::single ? 9 * count
                                            : kQuantisationFrameWords + (9 * count + 1) / 2;
}

/// The unit of storage of packed leaves: each begins at a multiple of so many words.
constexpr std::size_t words_per_block(LeafEncoding encoding) noexcept {
    return encoding == LeafEncoding::single ? 10 : 4;
}

/// Blocks that a leaf of `count` triangles takes.
constexpr std::size_t leaf_blocks(LeafEncoding encoding, std::size_t count) noexcept {
    const std::size_t block = words_per_block(encoding);
    return (triangle_ids_offset(encoding, count) + count + block - 1) / block;
}

/// pack_leaf() in single precision.
geometry::Aabb pack_single_leaf(std::uint32_t* words,
                                std::size_t count,
                                const geometry::MeshView& mesh) noexcept;

/// Packs the vertices of a leaf, whose triangle indices are set, and returns its box.
geometry::Aabb pack_leaf(LeafEncoding encoding,
                         std::uint32_t* words,
                         std::size_t count,
                         const geometry::MeshView& mesh) noexcept;

}  // namespace earshot::bvh
