// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/traverse.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/overlap.h"

#include <algorithm>
#include <concepts>
#include <vector>

namespace earshot::bvh {

// Which triangles share a point with a box, a sphere, a frustum or another triangle, contact
// included: geometry/overlap.h says how that is decided. Trees are those of ray.h; answers depend
// on the mesh alone.

/// Calls visit(triangle) for every triangle that the region touches, in any order, until it returns
/// false. Does not allocate.
template <geometry::OverlapRegion Region, std::predicate<geometry::TriangleId> Visit>
void visit_overlapping(const Tree& tree,
                       const geometry::MeshView& mesh,
                       const Region& region,
                       Visit&& visit) {
    traverse(
        tree,
        [&](const Node& node) { return region.may_touch(node.box); },
        [&](geometry::TriangleId id) {
            const auto [a, b, c] = geometry::corners(mesh, id);
            return !region.touches(a, b, c) || visit(id);
        });
}

/// All triangles that the region touches, ascending.
template <geometry::OverlapRegion Region>
std::vector<geometry::TriangleId> overlapping(const Tree& tree,
                                              const geometry::MeshView& mesh,
                                              const Region& region) {
    std::vector<geometry::TriangleId> found;
    visit_overlapping(tree, mesh, region, [&](geometry::TriangleId id) {
        found.push_back(id);
        return true;
    });
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace earshot::bvh
