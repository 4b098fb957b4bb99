// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// Triangles [begin, end) of a mesh, one part of a scene for example.
struct TriangleRange {
    std::uint32_t begin = 0, end = 0;
};

/// Where the triangles of a wide tree stand, for refits whose cost follows what has moved. Valid as
/// long as the tree's topology is.
class PartialRefit {
public:
    /// O(n); 4 bytes per triangle.
    explicit PartialRefit(const WideTree& tree);

    /// Refits the tree to the mesh where triangles of these ranges lie, and above: the same bits as
    /// WideTree::refit(), if nothing else has moved. Costs as much per triangle, and a byte read
    /// per node of the whole tree. Preconditions: the tree given first, refitted since or not;
    /// ranges within the mesh, overlapping or not.
    void refit(WideTree& tree,
               const geometry::MeshView& mesh,
               std::span<const TriangleRange> moved);

private:
    std::vector<std::uint32_t> node_of_;  // of each triangle
    std::vector<std::uint32_t> parents_;  // of each node
    std::vector<std::uint8_t> marks_;     // of each node, all 0 between calls
};

}  // namespace earshot::bvh
