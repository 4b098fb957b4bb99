// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

// How nodes and leaves of a WideTree are filled.

/// A slot's box.
geometry::Aabb slot_box(const WideNode& node, std::size_t slot) noexcept;
void set_slot_box(WideNode& node, std::size_t slot, const geometry::Aabb& box) noexcept;

/// The union of the slots.
geometry::Aabb box_of(const WideNode& node) noexcept;

/// Sorts the slots along the eight diagonals.
void set_order(WideNode& node) noexcept;

/// Ask the memory for what fill_leaf() will read: first the triangles, and when they have come
/// their corners.
void fetch_triangles(std::span<const std::uint32_t> triangles,
                     const geometry::MeshView& mesh) noexcept;
void fetch_corners(std::span<const std::uint32_t> triangles,
                   const geometry::MeshView& mesh) noexcept;

// A quantised leaf begins with its frame.
inline constexpr std::size_t kQuantisationFrameWords = 4;

/// Words of a leaf of `count` triangles before their indices.
constexpr std::size_t triangle_ids_offset(LeafEncoding form, std::size_t count) noexcept {
    return form == LeafEncoding::single ? 9 * count : kQuantisationFrameWords + (9 * count + 1) / 2;
}

/// Leaves begin at multiples of so many words, a place.
constexpr std::size_t words_per_block(LeafEncoding form) noexcept {
    return form == LeafEncoding::single ? 10 : 4;
}

/// Places that a leaf of `count` triangles takes.
constexpr std::size_t leaf_blocks(LeafEncoding form, std::size_t count) noexcept {
    const std::size_t place = words_per_block(form);
    return (triangle_ids_offset(form, count) + count + place - 1) / place;
}

/// Fills a leaf whose triangle indices are set from the mesh, and returns its box.
geometry::Aabb fill_leaf(LeafEncoding form,
                         std::uint32_t* words,
                         std::size_t count,
                         const geometry::MeshView& mesh) noexcept;

}  // namespace earshot::bvh
