// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/traverse.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <concepts>
#include <optional>

namespace earshot::bvh {

// Queries over a tree whose primitive i is triangle i of the mesh, in the box triangle_boxes()
// gives it. Answers depend on the mesh alone, never on the tree. They do not allocate; const trees
// may be queried from many threads.

/// The closest hit, on either side of a triangle; of hits at the same t the lowest TriangleId.
/// Decided by geometry::PreparedRay.
std::optional<geometry::Hit> closest_hit(const Tree& tree,
                                         const geometry::MeshView& mesh,
                                         const geometry::Ray& ray) noexcept;

/// Whether a triangle shares a point with the closed segment, decided exactly (geometry::touches),
/// and `accept(triangle, t)` holds for it (an any-hit filter), where t (0 ... 1, rounded) is the
/// parameter at which the segment first touches it. Triangles are offered in any order until one is
/// accepted.
template <std::predicate<geometry::TriangleId, double> Accept>
bool any_hit(const Tree& tree,
             const geometry::MeshView& mesh,
             const geometry::Segment& segment,
             Accept&& accept);

/// Whether any triangle shares a point with the closed segment.
bool occluded(const Tree& tree,
              const geometry::MeshView& mesh,
              const geometry::Segment& segment) noexcept;

/// The largest absolute coordinate of the tree's root box, metres; 0 without boxes.
double max_abs_coordinate(const Tree& tree) noexcept;

template <std::predicate<geometry::TriangleId, double> Accept>
bool any_hit(const Tree& tree,
             const geometry::MeshView& mesh,
             const geometry::Segment& segment,
             Accept&& accept) {
    // The end may lie a rounding past 1, which is less than the padding of SlabTest.
    const geometry::SlabTest slab_test(
        segment.from, segment.to - segment.from, max_abs_coordinate(tree));
    bool is_accepted = false;
    traverse(
        tree,
        [&](const Node& node) { return !slab_test.interval(node.box, 1.0).is_empty(); },
        [&](geometry::TriangleId id) {
            const auto [a, b, c] = geometry::corners(mesh, id);
            const auto touch = geometry::first_touch(segment, a, b, c);
            is_accepted = touch && accept(id, *touch);
            return !is_accepted;
        });
    return is_accepted;
}

}  // namespace earshot::bvh
