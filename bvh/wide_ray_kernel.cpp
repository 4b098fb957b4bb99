// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_ray_kernel.h"

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <cstddef>
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
    ExactSearch search(tree, source, ray.t_max);
    traverse_single_ray(tree.nodes().data(), ray, ray.t_max, [&](std::uint32_t leaf) {
        search.visit({tree.packed_leaf(leaf), leaf_count(leaf)}, ray);
        return search.bound;
    });
    search.get(hit);
}

/// In any tree: candidates are decided at the end, from the mesh, when it has been fetched.
HWY_INLINE void closest_deferred(const WideTree& tree,
                                 const geometry::MeshView& mesh,
                                 const geometry::Ray& source,
                                 const FloatRay& ray,
                                 std::optional<geometry::Hit>& hit) {
    DecodeBuffer buffer;
    ClosestHitSearch search(mesh, source, tree.max_abs_coordinate());
    search.bound = ray.t_max;
    traverse_single_ray(tree.nodes().data(), ray, ray.t_max, [&](std::uint32_t leaf) {
        visit_leaf(decode_leaf(tree, leaf, buffer), ray, search);
        return search.bound;
    });
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
    DecodeBuffer buffer;
    return traverse_single_segment(tree.nodes().data(), ray, [&](std::uint32_t leaf) {
        return touches_leaf(decode_leaf(tree, leaf, buffer), ray, mesh, segment);
    });
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(closest);
HWY_EXPORT(any);

namespace {

/// HWY_DYNAMIC_DISPATCH without a call of Highway's library for every ray.
template <typename Function, std::size_t kSets>
HWY_INLINE Function* chosen(Function* const (&table)[kSets]) {
    if constexpr (kSets == 1) {
        return table[0];
    } else {
        static const hwy::ChosenTarget& target = hwy::GetChosenTarget();
        return table[target.GetIndex()];
    }
}

}  // namespace

bool find_closest(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  const geometry::Ray& ray,
                  std::optional<geometry::Hit>& hit) noexcept {
    return chosen(HWY_DISPATCH_TABLE(closest))(tree, mesh, ray, hit);
}

std::optional<bool> find_any(const WideTree& tree,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             double reach) noexcept {
    return chosen(HWY_DISPATCH_TABLE(any))(tree, mesh, segment, reach);
}

}  // namespace earshot::bvh
#endif
