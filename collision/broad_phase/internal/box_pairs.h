// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/relative_pose.h"
#include "earshot/collision/narrow_phase/internal/leaf_pairs.h"

#include <cstdint>
#include <vector>

namespace earshot::collision {

// Simultaneous traversal of two BVHs, compiled for every instruction set. Boxes are in single
// precision and padded, so that no pair of triangles is culled wrongly. Every node whose boxes are
// tested against another box counts as so many box tests in the search's statistics.

/// A box of each of two shapes: eight times the node's index plus the slot. The roots are {0, 0}.
struct BoxPair {
    std::uint32_t a, b;
};

/// Both BVHs and their relative pose. The bodies' shapes are not empty.
struct BoxPairs {
    std::span<const BoxNode> a, b;
    const RelativePose& pose;
    std::span<const Corners> a_corners, b_corners;
};

/// Adds all pairs of triangles below `from` whose boxes overlap, until the search is satisfied.
void traverse_overlapping(const BoxPairs& trees, BoxPair from, ContactSearch& search);

/// The overlapping pairs that a pair expands into; a pair of triangles is returned itself. Adds to
/// the number of boxes that were tested.
std::vector<BoxPair> expand_overlapping(const BoxPairs& trees,
                                        BoxPair pair,
                                        std::uint64_t& box_tests);

/// Adds the overlapping pairs of triangles of one shape that lie below different children of a
/// node.
void traverse_self(const BoxPairs& trees, std::uint32_t node, ContactSearch& search);

/// Adds pairs of triangles whose boxes are within the search's bound, from the roots, closest
/// first.
void traverse_closest(const BoxPairs& trees, DistanceSearch& search);

}  // namespace earshot::collision
