// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"

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
void fetch_leaf_triangles(const std::uint32_t* words,
                          std::size_t count,
                          const geometry::MeshView& mesh) noexcept;
void fetch_leaf_corners(const std::uint32_t* words,
                        std::size_t count,
                        const geometry::MeshView& mesh) noexcept;

/// Fills a leaf whose triangle indices are set from the mesh, and returns its box.
geometry::Aabb fill_leaf(std::uint32_t* words,
                         std::size_t count,
                         const geometry::MeshView& mesh) noexcept;

}  // namespace earshot::bvh
