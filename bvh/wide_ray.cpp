// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_ray.h"

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/internal/wide_ray_kernel.h"
#include "earshot/bvh/traverse_wide.h"

namespace earshot::bvh {

using geometry::Hit;

std::optional<Hit> closest_hit(const WideTree& tree,
                               const geometry::MeshView& mesh,
                               const geometry::Ray& ray) noexcept {
    std::optional<Hit> hit;
    if (tree.nodes().empty() || find_closest(tree, mesh, ray, hit)) {
        return hit;
    }
    // A ray outside the range of FloatRay: every candidate is decided at once.
    const double max_abs_coordinate = tree.max_abs_coordinate();
    if (const geometry::PreparedRay prepared(ray, max_abs_coordinate); prepared.is_valid()) {
        ClosestHitSearch search(mesh, ray, max_abs_coordinate);
        search.bound = geometry::round_up(ray.t_max);
        traverse(
            tree,
            [&](const geometry::Aabb& box) {
                return !prepared.box_interval(box, search.t_max()).is_empty();
            },
            [&](geometry::TriangleId id) {
                search.add(id, 0.0F);
                search.decide_candidates();
                return true;
            });
        hit = search.best();
    }
    return hit;
}

bool occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              const geometry::Segment& segment) noexcept {
    if (tree.nodes().empty()) {
        return false;
    }
    const double max_abs_coordinate = tree.max_abs_coordinate();
    if (const auto found = find_any(tree, mesh, segment, max_abs_coordinate)) {
        return *found;
    }
    // A segment outside the range of FloatRay.
    const geometry::SlabTest slab_test(segment.from, segment.to - segment.from, max_abs_coordinate);
    bool is_blocked = false;
    traverse(
        tree,
        [&](const geometry::Aabb& box) { return !slab_test.interval(box, 1.0).is_empty(); },
        [&](geometry::TriangleId id) {
            const auto [a, b, c] = geometry::corners(mesh, id);
            is_blocked = geometry::touches(segment, a, b, c);
            return !is_blocked;
        });
    return is_blocked;
}

}  // namespace earshot::bvh
