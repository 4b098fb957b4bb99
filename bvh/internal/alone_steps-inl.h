// SPDX-License-Identifier: MIT
//
// Rays that leave surfaces on their way through a WideTree, one after the other. Included by
// kernels once per instruction set, after decision_queue-inl.h, float_ray-inl.h and
// wide_steps-inl.h.

#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#if defined(EARSHOT_BVH_ALONE_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_ALONE_STEPS_INL_H
#undef EARSHOT_BVH_ALONE_STEPS_INL_H
#else
#define EARSHOT_BVH_ALONE_STEPS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// Goes through the tree; `bound` is read before each step, and visit(leaf) returns whether to go
/// on.
template <typename Visit>
HWY_INLINE void walk_alone(const WideTree& tree,
                           const FloatRay& ray,
                           const PassingFromPlane& passing,
                           const float& bound,
                           Visit&& visit) {
    const WideNode* nodes = tree.nodes().data();
    Walk walk;
    LeafRoom room;
    bool goes_on = true;
    while (goes_on) {
        if (is_leaf(walk.child)) {
            goes_on = visit(open_leaf(tree, walk.child, room)) && walk.pop(bound);
        } else {
            goes_on = descend_alone(nodes[walk.child], passing, ray.order_shift, bound, walk);
        }
    }
}

/// Searches for the closest hits, and leaves the last word to the queue.
HWY_INLINE void closest_alone(const WideTree& tree,
                              const geometry::MeshView& mesh,
                              const LeavingRays& leaving,
                              std::span<std::optional<geometry::Hit>> hits,
                              DecisionQueue& queue) {
    const double reach = tree.reach();
    for (std::size_t i = 0; i < leaving.rays.size(); ++i) {
        FloatRay ray;
        if (!set_ray(ray, leaving.rays[i], static_cast<float>(reach))) {
            hits[i] = closest_hit(tree, mesh, leaving.rays[i]);
            continue;
        }
        const PassingFromPlane passing(ray, LeftPlane(mesh, leaving.left[i]));
        ClosestSearch search(mesh, leaving.rays[i], reach);
        search.bound = ray.t_max;
        walk_alone(tree, ray, passing, search.bound, [&](const LeafWords& leaf) {
            visit_leaf(leaf, ray, search, leaving.left[i]);
            return true;
        });
        hits[i] = search.best();
        search.for_each_left([&](std::uint32_t triangle) { queue.push(i, triangle); });
    }
}

/// Sets what is blocked.
HWY_INLINE void any_alone(const WideTree& tree,
                          const geometry::MeshView& mesh,
                          const LeavingSegments& leaving,
                          std::span<std::uint8_t> blocked) {
    const auto reach = static_cast<float>(tree.reach());
    for (std::size_t i = 0; i < leaving.segments.size(); ++i) {
        const geometry::Segment& segment = leaving.segments[i];
        FloatRay ray;
        if (!set_ray(ray, ray_along(segment), reach)) {
            blocked[i] = occluded(tree, mesh, segment) ? 1 : 0;
            continue;
        }
        const PassingFromPlane passing(ray, LeftPlane(mesh, leaving.left[i]));
        bool is_blocked = false;
        walk_alone(tree, ray, passing, ray.t_max, [&](const LeafWords& leaf) {
            is_blocked = touches_leaf(leaf, ray, mesh, segment, leaving.left[i]);
            return !is_blocked;
        });
        blocked[i] = is_blocked ? 1 : 0;
    }
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
