// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/wide_tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// Triangles [begin, end) of a mesh, one part of a scene for example.
struct TriangleRange {
    std::uint32_t begin = 0, end = 0;
};

/// A flag per triangle: whether a vertex of it is elsewhere than before. Precondition: there were
/// as many vertices.
std::vector<std::uint8_t> moved_flags(const geometry::MeshView& mesh,
                                      std::span<const geometry::Vec3> before,
                                      Executor& executor = Executor::serial());

/// The ranges of flags that are set, ascending and as long as can be.
std::vector<TriangleRange> ranges_of(std::span<const std::uint8_t> flags);

/// The ranges of the triangles of which a vertex is elsewhere than before.
inline std::vector<TriangleRange> moved_triangles(const geometry::MeshView& mesh,
                                                  std::span<const geometry::Vec3> before,
                                                  Executor& executor = Executor::serial()) {
    return ranges_of(moved_flags(mesh, before, executor));
}

/// Links from the triangles of a wide tree to its nodes and to their parents, for refits whose cost
/// follows what has moved. Valid as long as the topology does not change.
class PartialRefit {
public:
    /// O(n); 4 bytes per triangle.
    explicit PartialRefit(const WideTree& tree);

    /// Refits the leaves with triangles of these ranges and the nodes above them: the same bits as
    /// WideTree::refit(), if nothing else has moved. Costs as much per triangle, and a byte read
    /// per node of the whole tree. Preconditions: the tree given first, refitted since or not;
    /// ranges within the mesh, overlapping or not.
    void refit(WideTree& tree,
               const geometry::MeshView& mesh,
               std::span<const TriangleRange> moved);

private:
    std::vector<std::uint32_t> node_of_triangle_;  // the node whose leaf holds it
    std::vector<std::uint32_t> parents_;           // of each node
    std::vector<std::uint8_t> dirty_;              // flags of each node, all 0 between calls
};

}  // namespace earshot::bvh
