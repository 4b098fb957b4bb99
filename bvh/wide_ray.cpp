// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_ray.h"

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/internal/wide_ray_kernel.h"
#include "earshot/bvh/traverse_wide.h"

namespace earshot::bvh {

using geometry::Hit;

namespace {

// The cases outside the range of FloatRay: every candidate is decided at once. They are functions
// of their own, so that the others need no room on the stack for them.

[[gnu::noinline]] std::optional<Hit> closest_hit_in_double(const WideTree& tree,
                                                           const geometry::MeshView& mesh,
                                                           const geometry::Ray& ray) noexcept {
    const double max_abs_coordinate = tree.max_abs_coordinate();
    const geometry::PreparedRay prepared(ray, max_abs_coordinate);
    if (!prepared.is_valid()) {
        return std::nullopt;
    }
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
    return search.best();
}

[[gnu::noinline]] bool occluded_in_double(const WideTree& tree,
                                          const geometry::MeshView& mesh,
                                          const geometry::Segment& segment) noexcept {
    const geometry::SlabTest slab_test(
        segment.from, segment.to - segment.from, tree.max_abs_coordinate());
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

}  // namespace

std::optional<Hit> closest_hit(const WideTree& tree,
                               const geometry::MeshView& mesh,
                               const geometry::Ray& ray) noexcept {
    std::optional<Hit> hit;
    if (!tree.nodes().empty() && !find_closest(tree, mesh, ray, hit)) {
        hit = closest_hit_in_double(tree, mesh, ray);
    }
    return hit;
}

bool occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              const geometry::Segment& segment) noexcept {
    if (tree.nodes().empty()) {
        return false;
    }
    const auto found = find_any(tree, mesh, segment, tree.max_abs_coordinate());
    return found ? *found : occluded_in_double(tree, mesh, segment);
}

}  // namespace earshot::bvh
