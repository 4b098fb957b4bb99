// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace earshot::bvh {

/// The order of results: by distance, and at the same distance by triangle.
inline bool is_closer(const geometry::ClosestPoint& a, const geometry::ClosestPoint& b) noexcept {
    return a.distance != b.distance ? a.distance < b.distance : a.triangle < b.triangle;
}

/// Keeps the closest candidate.
class ClosestCollector {
public:
    explicit ClosestCollector(double max_distance) noexcept : max_distance_(max_distance) {}

    double max_distance() const noexcept { return max_distance_; }
    void add(const geometry::ClosestPoint& candidate) noexcept {
        if (!best_ || is_closer(candidate, *best_)) {
            best_ = candidate;
            max_distance_ = candidate.distance;
        }
    }
    const std::optional<geometry::ClosestPoint>& best() const noexcept { return best_; }

private:
    std::optional<geometry::ClosestPoint> best_;
    double max_distance_;
};

/// Gives the triangles of a leaf to a collector.
template <class Collector>
void collect_leaf(std::span<const geometry::TriangleId> leaf,
                  const geometry::MeshView& mesh,
                  const geometry::PreparedPoint& point,
                  Collector& collector) {
    for (const geometry::TriangleId id : leaf) {
        for (const geometry::VertexId vertex : mesh.triangles[id]) {
            __builtin_prefetch(&mesh.positions[vertex]);
        }
    }
    for (const geometry::TriangleId id : leaf) {
        const auto [a, b, c] = geometry::corners(mesh, id);
        auto found = point.closest_point(a, b, c, collector.max_distance());
        if (found) {
            found->triangle = id;
            collector.add(*found);
        }
    }
}

/// Branch-and-bound search that visits the closer child first (Roussopoulos, Kelley and Vincent
/// 1995) and gives triangles to a collector: collector.max_distance() is the distance beyond which
/// it takes none, and never grows; collector.add(point) takes one that is no farther. Does not
/// allocate.
template <class Collector>
void search_closest_points(const Tree& tree,
                           const geometry::MeshView& mesh,
                           const geometry::PreparedPoint& point,
                           Collector& collector) {
    struct StackEntry {
        std::uint32_t node = 0;
        double squared_distance = 0.0;
    };
    const auto nodes = tree.nodes();
    if (nodes.empty() || !point.is_valid()) {
        return;
    }
    // Each inner node on the way down leaves its farther child on the stack.
    std::array<StackEntry, kMaxDepth + 1> stack;
    std::size_t count = 0;
    double bound = point.squared_bound(collector.max_distance());
    stack[count++] = {0, point.squared_distance(nodes[0].box)};
    while (count > 0) {
        StackEntry current = stack[--count];
        // A box at the distance of the best triangle may hold one of lower index. Written so that
        // a bound that is not a number lets nothing pass.
        while (current.squared_distance <= bound) {
            const Node& node = nodes[current.node];
            if (node.is_leaf()) {
                collect_leaf(
                    tree.primitives().subspan(node.first, node.count), mesh, point, collector);
                bound = point.squared_bound(collector.max_distance());
                break;
            }
            const double to_left = point.squared_distance(nodes[node.first].box);
            const double to_right = point.squared_distance(nodes[node.first + 1].box);
            // Without a branch, which would be mispredicted half of the time.
            const auto is_right = static_cast<std::uint32_t>(to_right < to_left);
            stack[count] = {node.first + 1 - is_right, to_right < to_left ? to_left : to_right};
            count += stack[count].squared_distance <= bound ? 1 : 0;
            current = {node.first + is_right, to_right < to_left ? to_right : to_left};
        }
    }
}

}  // namespace earshot::bvh
