// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_ray.h"

#include "earshot/bvh/internal/wide_node.h"
#include "earshot/bvh/internal/wide_ray_kernel.h"

#include <array>

namespace earshot::bvh {

using geometry::Hit;

namespace {

/// Visits the leaves whose boxes pass `overlaps`, for rays outside the range of FloatRay; `visit`
/// returns false to stop.
template <typename Overlaps, typename Visit>
void traverse(const WideTree& tree, Overlaps&& overlaps, Visit&& visit) {
    std::array<std::uint32_t, (WideNode::kWidth - 1) * (kMaxDepth + 1) + 1> waiting;
    std::size_t count = 1;
    waiting[0] = 0;
    while (count > 0) {
        const WideNode& node = tree.nodes()[waiting[--count]];
        for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
            const geometry::Aabb box = slot_box(node, slot);
            const std::uint32_t child = node.child[slot];
            if (box.is_empty() || !overlaps(box)) {
                continue;
            }
            if (!is_leaf(child)) {
                waiting[count++] = child;
                continue;
            }
            for (const std::uint32_t id : tree.leaf_triangles(child)) {
                if (!visit(id)) {
                    return;
                }
            }
        }
    }
}

}  // namespace

std::optional<Hit> closest_hit(const WideTree& tree,
                               const geometry::MeshView& mesh,
                               const geometry::Ray& ray) noexcept {
    if (tree.nodes().empty()) {
        return std::nullopt;
    }
    const double reach = tree.max_abs_coordinate();
    ClosestHitSearch search(mesh, ray, reach);
    if (find_closest(tree, ray, reach, search)) {
        search.settle();
    } else if (const geometry::PreparedRay prepared(ray, reach); prepared.is_valid()) {
        search.bound = geometry::round_up(ray.t_max);
        const auto passes = [&](const geometry::Aabb& box) {
            return !prepared.box_interval(box, search.most()).is_empty();
        };
        traverse(tree, passes, [&](std::uint32_t id) {
            search.add(id, 0.0F);
            search.settle();
            return true;
        });
    }
    return search.best();
}

bool occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              const geometry::Segment& segment) noexcept {
    if (tree.nodes().empty()) {
        return false;
    }
    const double reach = tree.max_abs_coordinate();
    if (const auto found = find_any(tree, mesh, segment, reach)) {
        return *found;
    }
    const geometry::SlabTest slab_test(segment.from, segment.to - segment.from, reach);
    bool is_blocked = false;
    traverse(
        tree,
        [&](const geometry::Aabb& box) { return !slab_test.interval(box, 1.0).is_empty(); },
        [&](std::uint32_t id) {
            const auto [a, b, c] = geometry::corners(mesh, id);
            is_blocked = geometry::touches(segment, a, b, c);
            return !is_blocked;
        });
    return is_blocked;
}

}  // namespace earshot::bvh
