// SPDX-License-Identifier: MIT
#include "earshot/bvh/ray.h"

#include "earshot/bvh/better_hit.h"

#include <array>

namespace earshot::bvh {

using geometry::Hit;
using geometry::TriangleId;

double max_abs_coordinate(const Tree& tree) noexcept {
    return tree.nodes().empty() ? 0.0 : tree.nodes().front().box.max_abs_coordinate();
}

std::optional<Hit> closest_hit(const Tree& tree,
                               const geometry::MeshView& mesh,
                               const geometry::Ray& ray) noexcept {
    const geometry::PreparedRay prepared(ray, max_abs_coordinate(tree));
    const auto nodes = tree.nodes();
    if (nodes.empty() || !prepared.is_valid()) {
        return std::nullopt;
    }
    std::optional<Hit> best;
    double t_max = prepared.t_max();
    const auto test_leaf = [&](const Node& leaf) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const TriangleId id = tree.primitives()[i];
            const auto [a, b, c] = geometry::corners(mesh, id);
            auto hit = prepared.hit(a, b, c, t_max);
            if (!hit) {
                continue;
            }
            hit->triangle = id;
            if (!best || better_hit(*hit, *best)) {
                best = hit;
                t_max = hit->t;
            }
        }
    };

    struct StackEntry {
        std::uint32_t node = 0;
        double t_near = 0.0;
    };
    // Each inner node on the way down leaves its farther child on the stack.
    std::array<StackEntry, kMaxDepth + 1> stack;
    std::size_t count = 0;
    if (const auto root = prepared.box_interval(nodes[0].box, t_max); !root.is_empty()) {
        stack[count++] = {0, root.min};
    }
    while (count > 0) {
        StackEntry current = stack[--count];
        // A box that begins at the distance of the best hit may hold a triangle of lower index.
        if (current.t_near > t_max) {
            continue;
        }
        while (!nodes[current.node].is_leaf()) {
            const std::uint32_t left = nodes[current.node].first;
            const auto to_left = prepared.box_interval(nodes[left].box, t_max);
            const auto to_right = prepared.box_interval(nodes[left + 1].box, t_max);
            if (!to_left.is_empty() && !to_right.is_empty()) {
                const bool left_first = to_left.min <= to_right.min;
                stack[count++] =
                    left_first ? StackEntry{left + 1, to_right.min} : StackEntry{left, to_left.min};
                current.node = left_first ? left : left + 1;
            } else if (!to_left.is_empty() || !to_right.is_empty()) {
                current.node = to_left.is_empty() ? left + 1 : left;
            } else {
                break;
            }
        }
        if (nodes[current.node].is_leaf()) {
            test_leaf(nodes[current.node]);
        }
    }
    return best;
}

bool occluded(const Tree& tree,
              const geometry::MeshView& mesh,
              const geometry::Segment& segment) noexcept {
    return any_hit(tree, mesh, segment, [](TriangleId, double) { return true; });
}

}  // namespace earshot::bvh
