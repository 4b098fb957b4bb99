// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/wide_node_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/rounding-inl.h"
#include "earshot/bvh/kernels/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

constexpr std::size_t kWidth = WideNode::kWidth;
constexpr std::size_t kOctants = 4;  // of directions towards positive z

/// Sets keys[slot][octant] to the slot's place along the octant's diagonal. The lowest three bits,
/// of which single precision can spare so many, are the slot. Without a place, as of an empty slot,
/// it is the least number.
HWY_INLINE void set_keys(const WideNode& node, float (&keys)[kWidth][kOctants]) {
    const auto doubled_centre = [&](std::size_t axis) {
        return Float8::load(node.planes[2 * axis]) + Float8::load(node.planes[2 * axis + 1]);
    };
    const Float8 x = doubled_centre(0), y = doubled_centre(1), z = doubled_centre(2);
    const Float8 along[kOctants] = {z + x + y, z - x + y, z + x - y, z - x - y};
    alignas(32) std::uint32_t places[kOctants][kWidth];
    for (std::size_t octant = 0; octant < kOctants; ++octant) {
        const Float8 place = select(Float8(-kHighest) < along[octant],
                                    min(along[octant], Float8(kHighest)),
                                    Float8(-kHighest));
        store_bits(place, places[octant]);
    }
    for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
        for (std::size_t octant = 0; octant < kOctants; ++octant) {
            const std::uint32_t bits = (places[octant][slot] & ~7U) | slot;
            std::memcpy(&keys[slot][octant], &bits, sizeof bits);
        }
    }
}

/// Puts the larger numbers into `a`.
HWY_INLINE void exchange(Float4& a, Float4& b) {
    const Float4 larger = max(a, b);
    b = min(a, b);
    a = larger;
}

/// Sorts eight numbers in each lane, the largest first: Batcher's network of 19 comparisons (Knuth
/// 1998, section 5.3.4).
HWY_INLINE void sort_lanes(Float4 (&keys)[kWidth]) {
    exchange(keys[0], keys[1]), exchange(keys[2], keys[3]);
    exchange(keys[4], keys[5]), exchange(keys[6], keys[7]);
    exchange(keys[0], keys[2]), exchange(keys[1], keys[3]);
    exchange(keys[4], keys[6]), exchange(keys[5], keys[7]);
    exchange(keys[1], keys[2]), exchange(keys[5], keys[6]);
    exchange(keys[0], keys[4]), exchange(keys[1], keys[5]);
    exchange(keys[2], keys[6]), exchange(keys[3], keys[7]);
    exchange(keys[2], keys[4]), exchange(keys[3], keys[5]);
    exchange(keys[1], keys[2]), exchange(keys[3], keys[4]), exchange(keys[5], keys[6]);
}

HWY_INLINE void set_order(WideNode& node) {
    alignas(16) float keys[kWidth][kOctants];
    set_keys(node, keys);
    Float4 sorted[kWidth];
    for (std::size_t slot = 0; slot < kWidth; ++slot) {
        sorted[slot] = Float4::load(keys[slot]);
    }
    sort_lanes(sorted);
    std::uint32_t slots[kWidth][kOctants];
    for (std::size_t rank = 0; rank < kWidth; ++rank) {
        sorted[rank].store(keys[rank]);
    }
    std::memcpy(slots, keys, sizeof slots);
    for (std::size_t rank = 0; rank < kWidth; ++rank) {
        const auto& near = slots[rank];
        const auto& far = slots[kWidth - 1 - rank];
        // The opposite octants have the reverse orders.
        node.order[rank] = (near[0] & 7U) | (near[1] & 7U) << 3U | (near[2] & 7U) << 6U |
                           (near[3] & 7U) << 9U | (far[3] & 7U) << 12U | (far[2] & 7U) << 15U |
                           (far[1] & 7U) << 18U | (far[0] & 7U) << 21U;
    }
}

/// Sets the planes of the slots to those of eight nodes.
HWY_INLINE void set_planes(const Node* const (&boxes)[kWidth], WideNode& node) {
    // Four nodes at a time. A fourth number is read behind each corner, which has no use.
    for (std::size_t slot = 0; slot < kWidth; slot += 4) {
        const auto transposed = [&](std::size_t first) {
            const auto row = [&](std::size_t i) {
                return Float4::load_unaligned(boxes[slot + i]->box.lower.data() + first);
            };
            return transpose(row(0), row(1), row(2), row(3));
        };
        const ThreeAxes lower = transposed(0), upper = transposed(3);
        lower.x.store(node.planes[0] + slot);
        upper.x.store(node.planes[1] + slot);
        lower.y.store(node.planes[2] + slot);
        upper.y.store(node.planes[3] + slot);
        lower.z.store(node.planes[4] + slot);
        upper.z.store(node.planes[5] + slot);
    }
}

void set_boxes_and_order_of(WideNode& node, const Node* const (&boxes)[kWidth]) {
    set_planes(boxes, node);
    set_order(node);
}

geometry::Aabb pack_leaf_of(std::uint32_t* words,
                            std::size_t count,
                            const geometry::MeshView& mesh) {
    const std::uint32_t* const triangles = words + 9 * count;
    // Rounding is monotone, so the box of all vertices is rounded once.
    Double4 lower = load_three(&mesh.positions[mesh.triangles[triangles[0]][0]].x);
    Double4 upper = lower;
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t* word = words + i;
        for (const geometry::VertexId vertex : mesh.triangles[triangles[i]]) {
            const Double4 position = load_three(&mesh.positions[vertex].x);
            lower = min(lower, position);
            upper = max(upper, position);
            alignas(16) float rounded[4];
            round_to_float(position).store(rounded);
            for (std::size_t axis = 0; axis < 3; ++axis, word += count) {
                std::memcpy(word, &rounded[axis], sizeof(float));
            }
        }
    }
    alignas(16) float bounds[2][4];
    round_down(lower).store(bounds[0]);
    (Float4(0.0F) - round_down(Double4(0.0) - upper)).store(bounds[1]);
    geometry::Aabb box;
    std::copy_n(bounds[0], 3, box.lower.begin());
    std::copy_n(bounds[1], 3, box.upper.begin());
    return box;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(set_boxes_and_order_of);
HWY_EXPORT(pack_leaf_of);

void set_boxes_and_order(WideNode& node, const Node* const (&boxes)[WideNode::kWidth]) noexcept {
    HWY_DYNAMIC_DISPATCH(set_boxes_and_order_of)(node, boxes);
}

geometry::Aabb pack_single_leaf(std::uint32_t* words,
                                std::size_t count,
                                const geometry::MeshView& mesh) noexcept {
    return HWY_DYNAMIC_DISPATCH(pack_leaf_of)(words, count, mesh);
}

}  // namespace earshot::bvh
#endif
