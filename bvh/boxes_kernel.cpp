// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/boxes_kernel.h"

#include "earshot/bvh/internal/touch_pages.h"
#include "earshot/bvh/tree.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/boxes_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/rounding-inl.h"
#include "earshot/bvh/kernels/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

HWY_INLINE void store_aabb(Float4 lower, Float4 upper, geometry::Aabb& box) {
    alignas(16) float lanes[8];
    lower.store(lanes);
    upper.store(lanes + 4);
    std::memcpy(box.lower.data(), lanes, 3 * sizeof(float));
    std::memcpy(box.upper.data(), lanes + 4, 3 * sizeof(float));
}

void triangle_boxes_of(const geometry::MeshView& mesh,
                       std::size_t first,
                       std::span<geometry::Aabb> boxes) {
    const Double4 zero = Double4(0.0);
    // Vertices lie in memory in another order than triangles: they are asked for ahead.
    constexpr std::size_t kAhead = 16;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const std::size_t later = std::min(first + i + kAhead, mesh.triangles.size() - 1);
        for (const geometry::VertexId vertex : mesh.triangles[later]) {
            __builtin_prefetch(&mesh.positions[vertex]);
        }
        const geometry::Triangle& triangle = mesh.triangles[first + i];
        const Double4 a = load_three(&mesh.positions[triangle[0]].x);
        const Double4 b = load_three(&mesh.positions[triangle[1]].x);
        const Double4 c = load_three(&mesh.positions[triangle[2]].x);
        const Float4 lower = round_down(min(min(a, b), c));
        const Float4 upper = round_down(zero - max(max(a, b), c));
        store_aabb(lower, Float4(0.0F) - upper, boxes[i]);
    }
}

geometry::Aabb union_of(std::span<const geometry::Aabb> boxes,
                        std::span<const MortonPrimitive> primitives) {
    Float4 lower = Float4(kHighest), upper = Float4(-kHighest);
    for (const MortonPrimitive& primitive : primitives) {
        const float* const bounds = boxes[primitive.index].lower.data();
        lower = min(lower, Float4::load_unaligned(bounds));
        upper = max(upper, Float4::load_unaligned(bounds + 2));
    }
    geometry::Aabb result;
    store_aabb(lower + Float4(0.0F), rotate_by_one(upper) + Float4(0.0F), result);
    return result;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(triangle_boxes_of);
HWY_EXPORT(union_of);

void set_triangle_boxes(const geometry::MeshView& mesh,
                        std::size_t first,
                        std::span<geometry::Aabb> boxes) {
    HWY_DYNAMIC_DISPATCH(triangle_boxes_of)(mesh, first, boxes);
}

geometry::Aabb united_box(std::span<const geometry::Aabb> boxes,
                          std::span<const MortonPrimitive> primitives) {
    return HWY_DYNAMIC_DISPATCH(union_of)(boxes, primitives);
}

std::vector<geometry::Aabb> triangle_boxes(const geometry::MeshView& mesh, Executor& executor) {
    constexpr std::size_t kGrain = 16384;
    auto boxes = vector_on_touched_pages<geometry::Aabb>(mesh.triangles.size(), executor);
    executor.for_each(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        set_triangle_boxes(mesh, begin, std::span(boxes).subspan(begin, end - begin));
    });
    return boxes;
}

}  // namespace earshot::bvh
#endif
