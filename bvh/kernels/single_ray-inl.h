// SPDX-License-Identifier: MIT
//
// The single-ray kernel, compiled once per instruction set: secondary rays with an excluded
// triangle traverse a WideTree one after the other.

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/kernels/exact_queue-inl.h"
#include "earshot/bvh/kernels/float_ray-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/kernels/node-inl.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#if defined(EARSHOT_BVH_KERNELS_SINGLE_RAY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_SINGLE_RAY_INL_H
#undef EARSHOT_BVH_KERNELS_SINGLE_RAY_INL_H
#else
#define EARSHOT_BVH_KERNELS_SINGLE_RAY_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// Traverses the tree; `bound` is read before each step, and visit(leaf) returns whether to go
/// on.
template <typename Visit>
HWY_INLINE void traverse_single_ray(const WideTree& tree,
                                    const FloatRay& ray,
                                    const SlabTestSkippingCoplanar& slab_test,
                                    const float& bound,
                                    Visit&& visit) {
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    DecodeBuffer buffer;
    bool has_next = true;
    while (has_next) {
        if (is_leaf(stack.current)) {
            has_next = visit(decode_leaf(tree, stack.current, buffer)) && stack.pop(bound);
        } else {
            has_next =
                descend_single_ray(nodes[stack.current], slab_test, ray.order_shift, bound, stack);
        }
    }
}

/// Searches for the closest hits; the queue decides the last candidates.
HWY_INLINE void closest_single_ray(const WideTree& tree,
                                   const geometry::MeshView& mesh,
                                   const SecondaryRays& secondary_rays,
                                   std::span<std::optional<geometry::Hit>> hits,
                                   ExactTestQueue& queue) {
    const double reach = tree.max_abs_coordinate();
    for (std::size_t i = 0; i < secondary_rays.rays.size(); ++i) {
        FloatRay ray;
        if (!set_ray(ray, secondary_rays.rays[i], static_cast<float>(reach))) {
            hits[i] = closest_hit(tree, mesh, secondary_rays.rays[i]);
            continue;
        }
        const SlabTestSkippingCoplanar slab_test(
            ray, ExcludedPlane(mesh, secondary_rays.origin_triangles[i]));
        ClosestHitSearch search(mesh, secondary_rays.rays[i], reach);
        search.bound = ray.t_max;
        traverse_single_ray(tree, ray, slab_test, search.bound, [&](const LeafTriangles& leaf) {
            visit_leaf(leaf, ray, search, secondary_rays.origin_triangles[i]);
            return true;
        });
        hits[i] = search.best();
        search.for_each_pending([&](std::uint32_t triangle) { queue.push(i, triangle); });
    }
}

/// Sets whether each segment is blocked.
HWY_INLINE void any_single_ray(const WideTree& tree,
                               const geometry::MeshView& mesh,
                               const SecondarySegments& secondary_segments,
                               std::span<std::uint8_t> blocked) {
    const auto reach = static_cast<float>(tree.max_abs_coordinate());
    for (std::size_t i = 0; i < secondary_segments.segments.size(); ++i) {
        const geometry::Segment& segment = secondary_segments.segments[i];
        FloatRay ray;
        if (!set_segment(ray, segment, reach)) {
            blocked[i] = occluded(tree, mesh, segment) ? 1 : 0;
            continue;
        }
        const SlabTestSkippingCoplanar slab_test(
            ray, ExcludedPlane(mesh, secondary_segments.origin_triangles[i]));
        bool is_blocked = false;
        traverse_single_ray(tree, ray, slab_test, ray.t_max, [&](const LeafTriangles& leaf) {
            is_blocked =
                touches_leaf(leaf, ray, mesh, segment, secondary_segments.origin_triangles[i]);
            return !is_blocked;
        });
        blocked[i] = is_blocked ? 1 : 0;
    }
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
