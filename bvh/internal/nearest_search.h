// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

/// Nearer first, of equally near ones the lowest triangle.
inline bool comes_before(const geometry::NearPoint& a, const geometry::NearPoint& b) noexcept {
    return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
}

/// Offers the triangles of a leaf to a collector.
template <class Collector>
void offer(std::span<const geometry::TriangleId> leaf,
           const geometry::MeshView& mesh,
           const geometry::PreparedPoint& point,
           Collector& collector) {
    for (const geometry::TriangleId id : leaf) {
        for (const geometry::VertexId vertex : mesh.triangles[id]) {
            __builtin_prefetch(&mesh.positions[vertex]);
        }
    }
    for (const geometry::TriangleId id : leaf) {
        const geometry::Triangle& triangle = mesh.triangles[id];
        auto found = point.nearest(mesh.positions[triangle[0]],
                                   mesh.positions[triangle[1]],
                                   mesh.positions[triangle[2]],
                                   collector.most());
        if (found) {
            found->triangle = id;
            collector.add(*found);
        }
    }
}

/// Offers triangles to a collector, the nearest boxes first: collector.most() is the distance
/// beyond which it wants none, and never grows; collector.add(found) takes one that is no farther.
/// Does not allocate.
template <class Collector>
void search_nearest(const Tree& tree,
                    const geometry::MeshView& mesh,
                    const geometry::PreparedPoint& point,
                    Collector& collector) {
    struct Waiting {
        std::uint32_t node = 0;
        double squared_distance = 0.0;
    };
    const auto nodes = tree.nodes();
    if (nodes.empty() || !point.is_valid()) {
        return;
    }
    // Of each inner node on the way down one child waits here.
    std::array<Waiting, kMaxDepth + 1> waiting;
    std::size_t count = 0;
    double bound = point.squared_bound(collector.most());
    waiting[count++] = {0, point.squared_distance(nodes[0].box)};
    while (count > 0) {
        Waiting current = waiting[--count];
        // A box at the distance of the best triangle may hold one of lower index. Written so that
        // a bound that is not a number lets nothing pass.
        while (current.squared_distance <= bound) {
            const Node& node = nodes[current.node];
            if (node.is_leaf()) {
                offer(tree.primitives().subspan(node.first, node.count), mesh, point, collector);
                bound = point.squared_bound(collector.most());
                break;
            }
            const double to_left = point.squared_distance(nodes[node.first].box);
            const double to_right = point.squared_distance(nodes[node.first + 1].box);
            // Without a branch that no processor could foresee.
            const auto is_right = static_cast<std::uint32_t>(to_right < to_left);
            waiting[count] = {node.first + 1 - is_right, to_right < to_left ? to_left : to_right};
            count += waiting[count].squared_distance <= bound ? 1 : 0;
            current = {node.first + is_right, to_right < to_left ? to_right : to_left};
        }
    }
}

}  // namespace earshot::bvh
