// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_ray_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/wide_ray_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/wide_float.h"
#include "earshot/bvh/internal/float_ray-inl.h"
#include "earshot/bvh/internal/wide_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

bool closest(const WideTree& tree,
             const geometry::Ray& source,
             double reach,
             ClosestSearch& search) {
    FloatRay ray;
    if (!set_ray(ray, source, static_cast<float>(reach))) {
        return false;
    }
    const Passing passing(ray);
    const WideNode* nodes = tree.nodes().data();
    Walk walk;
    LeafRoom room;
    search.bound = ray.t_max;
    bool goes_on = true;
    while (goes_on) {
        if (is_leaf(walk.child)) {
            visit_leaf(open_leaf(tree, walk.child, room), ray, search);
            goes_on = walk.pop(search.bound);
        } else {
            goes_on =
                descend_alone(nodes[walk.child], passing, ray.order_shift, search.bound, walk);
        }
    }
    return true;
}

std::optional<bool> any(const WideTree& tree,
                        const geometry::MeshView& mesh,
                        const geometry::Segment& segment,
                        double reach) {
    FloatRay ray;
    if (!set_ray(ray, ray_along(segment), static_cast<float>(reach))) {
        return std::nullopt;
    }
    const Passing passing(ray);
    const WideNode* nodes = tree.nodes().data();
    Walk walk;
    LeafRoom room;
    bool goes_on = true;
    while (goes_on) {
        if (!is_leaf(walk.child)) {
            goes_on = descend_alone(nodes[walk.child], passing, ray.order_shift, ray.t_max, walk);
        } else if (touches_leaf(open_leaf(tree, walk.child, room), ray, mesh, segment)) {
            return true;
        } else {
            goes_on = walk.pop(ray.t_max);
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
                  ClosestSearch& search) noexcept {
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
