// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/relative_pose.h"
#include "earshot/collision/narrow_phase/internal/leaf_pairs.h"

#include <cstdint>
#include <vector>

namespace earshot::collision {

// Walks over pairs of boxes of two hierarchies, compiled for every instruction set. They cull with
// boxes in single precision, padded, so that no pair of triangles is lost.

/// A box of each of two shapes: eight times the node's index plus the slot. The roots are {0, 0}.
struct BoxPair {
    std::uint32_t a, b;
};

/// Both hierarchies and how they lie. The bodies' shapes are not empty.
struct BoxPairs {
    std::span<const BoxNode> a, b;
    const RelativePose& pose;
    std::span<const Corners> a_corners, b_corners;
};

/// Adds all pairs of triangles below a pair whose boxes overlap, until the search has enough.
void find_touching(const BoxPairs& trees, BoxPair from, ContactSearch& search);

/// The pairs that a pair is opened into, those that are apart left out; of two triangles itself.
std::vector<BoxPair> open_touching(const BoxPairs& trees, BoxPair pair);

/// Adds all pairs of triangles of one shape under two of the node's children, as find_touching().
void find_touching_within(const BoxPairs& trees, std::uint32_t node, ContactSearch& search);

/// Adds pairs of triangles from the root on whose boxes are within the search's bound.
void find_nearest(const BoxPairs& trees, DistanceSearch& search);

}  // namespace earshot::collision
