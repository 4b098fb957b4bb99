// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/intersect.h"

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace earshot::bvh {

// Traversals of a WideTree in double precision, as traverse.h has one of a Tree. The kernels that
// wide_ray.h and wide_batch.h use cull in single precision; these serve queries that kernels do not
// have, and rays outside of their range.

/// Each wide node on the way down leaves seven children on the stack, the last one eight.
inline constexpr std::size_t kMaxWideStackSize = (WideNode::kWidth - 1) * (kMaxDepth + 1) + 1;

/// Visits every triangle in a leaf whose box and all boxes above it pass `overlaps`, in any order;
/// `visit` returns false to stop. Does not allocate.
template <std::predicate<const geometry::Aabb&> Overlaps,
          std::predicate<geometry::TriangleId> Visit>
void traverse(const WideTree& tree, Overlaps&& overlaps, Visit&& visit) {
    if (tree.nodes().empty()) {
        return;
    }
    std::array<std::uint32_t, kMaxWideStackSize> stack;
    std::size_t count = 1;
    stack[0] = 0;
    while (count > 0) {
        const WideNode& node = tree.nodes()[stack[--count]];
        for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
            const geometry::Aabb box = slot_box(node, slot);
            const std::uint32_t child = node.child[slot];
            if (box.is_empty() || !overlaps(box)) {
                continue;
            }
            if (!is_leaf(child)) {
                stack[count++] = child;
                continue;
            }
            for (const geometry::TriangleId id : tree.leaf_triangles(child)) {
                if (!visit(id)) {
                    return;
                }
            }
        }
    }
}

/// For traversals that filter no slots.
inline bool every_slot(std::uint32_t, std::size_t) noexcept {
    return true;
}

/// Visits the triangles in the leaves whose boxes a segment hits, roughly front to back, until
/// `visit` returns false. Slots of a node are skipped unless `filter(node, slot)`, and boxes that
/// begin beyond `t_max`, which `visit` may lower from the 1 of the segment's end. Returns the
/// number of nodes whose slots were tested. Does not allocate.
template <std::predicate<std::uint32_t, std::size_t> Filter,
          std::predicate<geometry::TriangleId> Visit>
std::size_t traverse_front_to_back(const WideTree& tree,
                                   const geometry::Segment& segment,
                                   const double& t_max,
                                   Filter&& filter,
                                   Visit&& visit) {
    struct StackEntry {
        std::uint32_t child;
        double t_near;
    };
    if (tree.nodes().empty()) {
        return 0;
    }
    std::array<StackEntry, kMaxWideStackSize> stack;
    const geometry::Vec3 direction = segment.to - segment.from;
    const geometry::SlabTest slab_test(segment.from, direction, tree.max_abs_coordinate());
    const int octant = (std::signbit(direction.x) ? 1 : 0) + (std::signbit(direction.y) ? 2 : 0) +
                       (std::signbit(direction.z) ? 4 : 0);
    std::size_t visited = 0;
    std::size_t count = 1;
    stack[0] = {0, 0.0};
    while (count > 0) {
        const StackEntry current = stack[--count];
        if (current.t_near > t_max) {
            continue;
        }
        if (is_leaf(current.child)) {
            for (const geometry::TriangleId id : tree.leaf_triangles(current.child)) {
                if (!visit(id)) {
                    return visited;
                }
            }
            continue;
        }
        ++visited;
        // The farthest child is pushed first, so that the closest is on top.
        const WideNode& node = tree.nodes()[current.child];
        for (std::size_t rank = 0; rank < WideNode::kWidth; ++rank) {
            const std::size_t slot = node.order[rank] >> (3 * octant) & 7U;
            const geometry::Aabb box = slot_box(node, slot);
            if (box.is_empty() || !filter(current.child, slot)) {
                continue;
            }
            if (const auto interval = slab_test.interval(box, t_max); !interval.is_empty()) {
                stack[count++] = {node.child[slot], interval.min};
            }
        }
    }
    return visited;
}

}  // namespace earshot::bvh
