// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/intersect.h"

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace earshot::visibility {

// The exact tests of geometry for a triangle of a mesh.

inline bool touches(const geometry::Segment& segment,
                    const geometry::MeshView& mesh,
                    geometry::TriangleId id) noexcept {
    const auto [a, b, c] = geometry::corners(mesh, id);
    return geometry::touches(segment, a, b, c);
}
inline std::optional<double> first_touch(const geometry::Segment& segment,
                                         const geometry::MeshView& mesh,
                                         geometry::TriangleId id) noexcept {
    const auto [a, b, c] = geometry::corners(mesh, id);
    return geometry::first_touch(segment, a, b, c);
}

/// What stands in a slot of a node.
inline geometry::Aabb slot_box(const bvh::WideNode& node, std::size_t slot) noexcept {
    geometry::Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] = node.planes[2 * axis][slot];
        box.upper[axis] = node.planes[2 * axis + 1][slot];
    }
    return box;
}

/// Takes a segment through the boxes of a tree in double precision, near ones first, and calls
/// `visit(triangle)` for what stands in the leaves until it returns false. A slot of a node is left
/// out unless `opens(node, slot)`, and what begins beyond `most`, which `visit` may lower from the
/// 1 of the far end. Returns how many nodes were looked into. Does not allocate.
template <std::predicate<std::uint32_t, std::size_t> Opens,
          std::predicate<geometry::TriangleId> Visit>
std::size_t walk(const bvh::WideTree& tree,
                 const geometry::Segment& segment,
                 const double& most,
                 Opens&& opens,
                 Visit&& visit) {
    constexpr std::size_t kWidth = bvh::WideNode::kWidth;
    struct Waiting {
        std::uint32_t child;
        double near;
    };
    // Of each node on the way down seven children wait here, of the last one eight.
    std::array<Waiting, (kWidth - 1) * (bvh::kMaxDepth + 1) + 1> waiting;
    if (tree.nodes().empty()) {
        return 0;
    }
    const geometry::Vec3 direction = segment.to - segment.from;
    const geometry::SlabTest slab_test(segment.from, direction, tree.max_abs_coordinate());
    const int shift =
        3 * ((std::signbit(direction.x) ? 1 : 0) + (std::signbit(direction.y) ? 2 : 0) +
             (std::signbit(direction.z) ? 4 : 0));
    std::size_t visited = 0;
    std::size_t count = 1;
    waiting[0] = {0, 0.0};
    while (count > 0) {
        const Waiting current = waiting[--count];
        if (current.near > most) {
            continue;
        }
        if (bvh::is_leaf(current.child)) {
            for (const geometry::TriangleId id : tree.leaf_triangles(current.child)) {
                if (!visit(id)) {
                    return visited;
                }
            }
            continue;
        }
        ++visited;
        const bvh::WideNode& node = tree.nodes()[current.child];
        for (std::size_t rank = 0; rank < kWidth; ++rank) {
            const std::size_t slot = node.order[rank] >> shift & 7U;
            const geometry::Aabb box = slot_box(node, slot);
            if (box.is_empty() || !opens(current.child, slot)) {
                continue;
            }
            if (const geometry::Interval interval = slab_test.interval(box, most);
                !interval.is_empty()) {
                waiting[count++] = {node.child[slot], interval.min};
            }
        }
    }
    return visited;
}

/// For walks that leave nothing out.
inline bool opens_all(std::uint32_t, std::size_t) noexcept {
    return true;
}

}  // namespace earshot::visibility
