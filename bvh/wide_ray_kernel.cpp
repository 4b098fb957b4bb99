// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_ray_kernel.h"

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <optional>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/wide_ray_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/bvh/kernels/exact_search-inl.h"
#include "earshot/bvh/kernels/float_ray-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/kernels/node-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// In a tree whose packed leaves hold the vertices exactly.
HWY_INLINE void closest_exact(const WideTree& tree,
                              const geometry::Ray& source,
                              const FloatRay& ray,
                              std::optional<geometry::Hit>& hit) {
    const SlabTest slab_test(ray);
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    ExactSearch search(tree, source, ray.t_max);
    bool has_next = true;
    while (has_next) {
        if (is_leaf(stack.current)) {
            search.visit({tree.packed_leaf(stack.current), leaf_count(stack.current)}, ray);
            has_next = stack.pop(search.bound);
        } else {
            has_next = descend_single_ray(
                nodes[stack.current], slab_test, ray.order_shift, search.bound, stack);
        }
    }
    search.get(hit);
}

/// In any tree: candidates are decided at the end, from the mesh, when it has been fetched.
HWY_INLINE void closest_deferred(const WideTree& tree,
                                 const geometry::MeshView& mesh,
                                 const geometry::Ray& source,
                                 const FloatRay& ray,
                                 std::optional<geometry::Hit>& hit) {
    const SlabTest slab_test(ray);
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    DecodeBuffer buffer;
    ClosestHitSearch search(mesh, source, tree.max_abs_coordinate());
    search.bound = ray.t_max;
    bool has_next = true;
    while (has_next) {
        if (is_leaf(stack.current)) {
            visit_leaf(decode_leaf(tree, stack.current, buffer), ray, search);
            has_next = stack.pop(search.bound);
        } else {
            has_next = descend_single_ray(
                nodes[stack.current], slab_test, ray.order_shift, search.bound, stack);
        }
    }
    search.decide_candidates();
    hit = search.best();
}

bool closest(const WideTree& tree,
             const geometry::MeshView& mesh,
             const geometry::Ray& source,
             std::optional<geometry::Hit>& hit) {
    FloatRay ray;
    if (!set_ray(ray, source, static_cast<float>(tree.max_abs_coordinate()))) {
        return false;
    }
    if (tree.exact_coordinates().are_known()) {
        closest_exact(tree, source, ray, hit);
    } else {
        closest_deferred(tree, mesh, source, ray, hit);
    }
    return true;
}

std::optional<bool> any(const WideTree& tree,
                        const geometry::MeshView& mesh,
                        const geometry::Segment& segment,
                        double reach) {
    FloatRay ray;
    if (!set_segment(ray, segment, static_cast<float>(reach))) {
        return std::nullopt;
    }
    const SlabTest slab_test(ray);
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    DecodeBuffer buffer;
    bool has_next = true;
    while (has_next) {
        if (!is_leaf(stack.current)) {
            has_next = descend_unordered(nodes[stack.current], slab_test, ray.t_max, stack);
        } else if (touches_leaf(decode_leaf(tree, stack.current, buffer), ray, mesh, segment)) {
            return true;
        } else {
            has_next = stack.pop_any();
        }
    }
    return false;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(closest);
HWY_EXPORT(any);

bool find_closest(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  const geometry::Ray& ray,
                  std::optional<geometry::Hit>& hit) noexcept {
    return HWY_DYNAMIC_DISPATCH(closest)(tree, mesh, ray, hit);
}

std::optional<bool> find_any(const WideTree& tree,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             double reach) noexcept {
    return HWY_DYNAMIC_DISPATCH(any)(tree, mesh, segment, reach);
}

}  // namespace earshot::bvh
#endif
