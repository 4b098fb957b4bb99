// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::bvh {

/// The group of a node with primitives of several groups.
inline constexpr std::uint32_t kMixedGroups = std::numeric_limits<std::uint32_t>::max();

/// A tree in which every group of primitives, such as the triangles of a mesh, has a subtree of its
/// own, below a top-level tree over the groups. Group g ends before primitive group_ends[g] and
/// begins where the one before it ends; groups may be empty. The tree may be deeper than kMaxDepth,
/// by another kMaxDepth. Throws as Tree::build(). Precondition: the last group ends with the boxes.
Tree build_grouped(std::span<const geometry::Aabb> boxes,
                   std::span<const std::size_t> group_ends,
                   const BuildOptions& options = {},
                   Executor& executor = Executor::serial());

/// The group of every node, kMixedGroups above the groups' subtrees. None without groups.
/// Precondition: nodes in depth-first order, as Tree has them, and leaves of one group each.
std::vector<std::uint32_t> groups_of_nodes(const Tree& tree,
                                           std::span<const std::size_t> group_ends);

}  // namespace earshot::bvh
