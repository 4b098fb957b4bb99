// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_ray_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/wide_ray_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/bvh/kernels/float_ray-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/kernels/node-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

bool closest(const WideTree& tree,
             const geometry::Ray& source,
             double reach,
             ClosestHitSearch& search) {
    FloatRay ray;
    if (!set_ray(ray, source, static_cast<float>(reach))) {
        return false;
    }
    const SlabTest slab_test(ray);
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    DecodeBuffer buffer;
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
            has_next = descend_single_ray(
                nodes[stack.current], slab_test, ray.order_shift, ray.t_max, stack);
        } else if (touches_leaf(decode_leaf(tree, stack.current, buffer), ray, mesh, segment)) {
            return true;
        } else {
            has_next = stack.pop(ray.t_max);
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
                  const geometry::Ray& ray,
                  double reach,
                  ClosestHitSearch& search) noexcept {
    return HWY_DYNAMIC_DISPATCH(closest)(tree, ray, reach, search);
}

std::optional<bool> find_any(const WideTree& tree,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             double reach) noexcept {
    return HWY_DYNAMIC_DISPATCH(any)(tree, mesh, segment, reach);
}

}  // namespace earshot::bvh
#endif
