// SPDX-License-Identifier: MIT
//
// Separating-axis tests of one box against up to eight boxes of another space, for kernels that are
// compiled once per instruction set (see base/simd/lanes-inl.h). All tests err to the side of
// overlap.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/tree.h"
#include "earshot/collision/broad_phase/internal/relative_pose.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#if defined(EARSHOT_COLLISION_BROAD_PHASE_INTERNAL_BOX_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_COLLISION_BROAD_PHASE_INTERNAL_BOX_STEPS_INL_H
#undef EARSHOT_COLLISION_BROAD_PHASE_INTERNAL_BOX_STEPS_INL_H
#else
#define EARSHOT_COLLISION_BROAD_PHASE_INTERNAL_BOX_STEPS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::collision::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the wide types

// On the way down through two trees, all children of each pair but one stay on the stack.
inline constexpr std::size_t kMaxStackSize = 2 * (BoxNode::kWidth - 1) * (bvh::kMaxDepth + 2) + 1;

HWY_INLINE std::uint32_t child_of(std::span<const BoxNode> nodes, std::uint32_t index) {
    return nodes[index / 8].child[index % 8];
}

/// One box of a node.
struct Slot {
    float centre[3], half[3];
    float normal[3], slab_centre, slab_half;
    std::uint32_t child;

    HWY_INLINE Slot(std::span<const BoxNode> nodes, std::uint32_t index) {
        const BoxNode& node = nodes[index / 8];
        const std::uint32_t slot = index % 8;
        for (std::size_t k = 0; k < 3; ++k) {
            centre[k] = node.centre[k][slot];
            half[k] = node.half[k][slot];
            normal[k] = node.normal[k][slot];
        }
        slab_centre = node.slab_centre[slot];
        slab_half = node.slab_half[slot];
        child = node.child[slot];
    }
    bool is_triangle() const { return (child & kTriangleFlag) != 0; }
    float size() const { return half[0] + half[1] + half[2]; }
};

/// Whether the first box of a pair is expanded: the larger one is, if it is not a triangle.
HWY_INLINE bool expands_first(const Slot& a, const Slot& b) {
    return b.is_triangle() || (!a.is_triangle() && a.size() >= b.size());
}

template <typename Visit>
HWY_INLINE void for_each_bit(std::uint32_t mask, Visit&& visit) {
    for (; mask != 0; mask &= mask - 1) {
        visit(static_cast<std::uint32_t>(std::countr_zero(mask)));
    }
}

/// A box in the space of a node (B in A), and its offset from each of the node's boxes.
struct RelativeBox {
    Float8 centre_offset[3];  // of the centres, along the node's axes
    Float8 half[3];           // half sides of the node's boxes
    float radius[3];          // projected onto the node's axes, padded

    HWY_INLINE RelativeBox(const BoxNode& node, const Slot& box, const RelativeFrame& frame) {
        for (std::size_t k = 0; k < 3; ++k) {
            float centre = frame.translation[k];
            float sum = frame.padding;
            for (std::size_t j = 0; j < 3; ++j) {
                centre += frame.rotation[k][j] * box.centre[j];
                sum += frame.abs_rotation[k][j] * box.half[j];
            }
            radius[k] = sum;
            centre_offset[k] = Float8(centre) - Float8::load(node.centre[k]);
            half[k] = Float8::load(node.half[k]);
        }
    }

    /// Component of the offset of centres along the box's axis j.
    HWY_INLINE Float8 along(const RelativeFrame& frame, std::size_t j) const {
        Float8 sum = centre_offset[0] * Float8(frame.rotation[0][j]);
        sum = mul_add(centre_offset[1], Float8(frame.rotation[1][j]), sum);
        return mul_add(centre_offset[2], Float8(frame.rotation[2][j]), sum);
    }
    /// The sum of both projected radii along that axis.
    HWY_INLINE Float8 radius_along(const Slot& box,
                                   const RelativeFrame& frame,
                                   std::size_t j) const {
        Float8 sum = Float8(box.half[j] + frame.padding);
        for (std::size_t k = 0; k < 3; ++k) {
            sum = mul_add(half[k], Float8(frame.abs_rotation[k][j]), sum);
        }
        return sum;
    }
};

/// Whether no slab normal separates its slab from the other box.
HWY_INLINE Float8::Mask slabs_overlap(const BoxNode& node,
                                      const Slot& slot,
                                      const RelativeBox& box,
                                      const RelativeFrame& frame) {
    Float8 node_distance = Float8(0.0F) - Float8::load(node.slab_centre);
    Float8 node_radius = Float8::load(node.slab_half) + Float8(frame.padding);
    Float8 box_distance = Float8(slot.slab_centre);
    Float8 box_radius = Float8(slot.slab_half + frame.padding);
    for (std::size_t k = 0; k < 3; ++k) {
        node_distance = mul_add(box.centre_offset[k], Float8::load(node.normal[k]), node_distance);
        const float normal = frame.rotation[k][0] * slot.normal[0] +
                             frame.rotation[k][1] * slot.normal[1] +
                             frame.rotation[k][2] * slot.normal[2];
        box_distance = mul_add(box.centre_offset[k], Float8(normal), box_distance);
        box_radius = mul_add(box.half[k], Float8(std::abs(normal)), box_radius);
        Float8 along = Float8::load(node.normal[0]) * Float8(frame.rotation[0][k]);
        along = mul_add(Float8::load(node.normal[1]), Float8(frame.rotation[1][k]), along);
        along = mul_add(Float8::load(node.normal[2]), Float8(frame.rotation[2][k]), along);
        node_radius = mul_add(abs(along), Float8(slot.half[k]), node_radius);
    }
    return (abs(node_distance) <= node_radius) & (abs(box_distance) <= box_radius);
}

/// Which boxes of a node may overlap the box: bit i stands for slot i. Gottschalk, Lin and
/// Manocha 1996, section 5, but for the products of edges, which cull little after the slabs.
HWY_INLINE std::uint32_t overlapping(const BoxNode& node,
                                     const Slot& slot,
                                     const RelativeFrame& frame,
                                     bool is_aligned) {
    const RelativeBox box(node, slot, frame);
    Float8::Mask mask = Float8::Mask::first(node.count);
    for (std::size_t k = 0; k < 3; ++k) {
        mask = mask & (abs(box.centre_offset[k]) <= box.half[k] + Float8(box.radius[k]));
    }
    if (is_aligned || bits(mask) == 0) {
        return bits(mask);
    }
    for (std::size_t j = 0; j < 3; ++j) {
        mask = mask & (abs(box.along(frame, j)) <= box.radius_along(slot, frame, j));
    }
    mask = mask & slabs_overlap(node, slot, box, frame);
    return bits(mask);
}

/// A triangle in the space of a node: its corners and its plane cull more than its box.
struct RelativeTriangle {
    float corner[3][3];  // coordinates of each corner along the node's axes
    float normal[3];
    float slack;  // half thickness of the corners' slab about the plane

    HWY_INLINE RelativeTriangle(const Slot& slot,
                                std::span<const Corners> corners,
                                const RelativeFrame& frame) {
        const Corners& own = corners[slot.child & ~kTriangleFlag];
        for (int k = 0; k < 3; ++k) {
            const float* rotation = frame.rotation[k];
            for (std::size_t i = 0; i < 3; ++i) {
                const geometry::Vec3& p = own[i];
                corner[i][k] = frame.translation[k] + (rotation[0] * static_cast<float>(p.x) +
                                                       rotation[1] * static_cast<float>(p.y) +
                                                       rotation[2] * static_cast<float>(p.z));
            }
            normal[k] = rotation[0] * slot.normal[0] + rotation[1] * slot.normal[1] +
                        rotation[2] * slot.normal[2];
        }
        slack = 2.0F * slot.slab_half + frame.padding;
    }
};

/// Which boxes of a node may overlap the triangle, with their slabs: along the node's axes, the
/// slabs' normals and the triangle's normal.
HWY_INLINE std::uint32_t overlapping(const BoxNode& node,
                                     const RelativeTriangle& box,
                                     float padding) {
    Float8::Mask mask = Float8::Mask::first(node.count);
    Float8 box_distance = Float8(0.0F);
    Float8 box_radius = Float8(box.slack);
    Float8 height[3];
    for (Float8& each : height) {
        each = Float8(0.0F) - Float8::load(node.slab_centre);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 centre = Float8::load(node.centre[k]);
        const Float8 half = Float8::load(node.half[k]);
        const Float8 normal = Float8::load(node.normal[k]);
        const Float8 p0 = Float8(box.corner[0][k]) - centre;
        const Float8 p1 = Float8(box.corner[1][k]) - centre;
        const Float8 p2 = Float8(box.corner[2][k]) - centre;
        const Float8 radius = half + Float8(padding);
        mask = mask & (min(min(p0, p1), p2) <= radius);
        mask = mask & (Float8(0.0F) - radius <= max(max(p0, p1), p2));
        height[0] = mul_add(p0, normal, height[0]);
        height[1] = mul_add(p1, normal, height[1]);
        height[2] = mul_add(p2, normal, height[2]);
        box_distance = mul_add(p0, Float8(box.normal[k]), box_distance);
        box_radius = mul_add(half, Float8(std::abs(box.normal[k])), box_radius);
    }
    const Float8 radius = Float8::load(node.slab_half) + Float8(padding);
    mask = mask & (min(min(height[0], height[1]), height[2]) <= radius);
    mask = mask & (Float8(0.0F) - radius <= max(max(height[0], height[1]), height[2]));
    return bits(mask & (abs(box_distance) <= box_radius));
}

/// Support of each node box along its own centre offset, from its centre: the direction is split
/// into a multiple of the slab's normal, bounded by the slab, and a rest, bounded by the box.
HWY_INLINE Float8 extent_of_node_slabs(const BoxNode& node, const RelativeBox& box) {
    const Float8 along_normal =
        mul_add(box.centre_offset[0],
                Float8::load(node.normal[0]),
                mul_add(box.centre_offset[1],
                        Float8::load(node.normal[1]),
                        box.centre_offset[2] * Float8::load(node.normal[2])));
    Float8 radius = mul_add(along_normal,
                            Float8::load(node.slab_centre),
                            abs(along_normal) * Float8::load(node.slab_half));
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 rest =
            neg_mul_add(along_normal, Float8::load(node.normal[k]), box.centre_offset[k]);
        radius = mul_add(abs(rest), box.half[k], radius);
    }
    return radius;
}

/// Support of the other box in the opposite direction; `centre_offset` holds the components of the
/// direction along its axes.
HWY_INLINE Float8 extent_of_box_slab(const Slot& slot, const Float8 (&centre_offset)[3]) {
    const Float8 along_normal = mul_add(
        centre_offset[0],
        Float8(slot.normal[0]),
        mul_add(
            centre_offset[1], Float8(slot.normal[1]), centre_offset[2] * Float8(slot.normal[2])));
    Float8 radius = neg_mul_add(
        along_normal, Float8(slot.slab_centre), abs(along_normal) * Float8(slot.slab_half));
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 rest = neg_mul_add(along_normal, Float8(slot.normal[k]), centre_offset[k]);
        radius = mul_add(abs(rest), Float8(slot.half[k]), radius);
    }
    return radius;
}

/// Which boxes of a node may be within a distance of the box, given its square, and lower bounds
/// of their squared distances: along the node's axes, along the box's axes, and the gap along the
/// line of centres.
HWY_INLINE std::uint32_t within_distance(const BoxNode& node,
                                         const Slot& slot,
                                         const RelativeFrame& frame,
                                         float squared_bound,
                                         float* squares) {
    const RelativeBox box(node, slot, frame);
    const Float8 zero = Float8(0.0F);
    Float8 in_node_space = zero;
    Float8 in_box_space = zero;
    Float8 length_squared = zero;
    Float8 length_bound = zero;
    Float8 rotated_offset[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 gap =
            max(zero, abs(box.centre_offset[k]) - (box.half[k] + Float8(box.radius[k])));
        in_node_space = mul_add(gap, gap, in_node_space);
        rotated_offset[k] = box.along(frame, k);
        const Float8 own = max(zero, abs(rotated_offset[k]) - box.radius_along(slot, frame, k));
        in_box_space = mul_add(own, own, in_box_space);
        length_squared = mul_add(box.centre_offset[k], box.centre_offset[k], length_squared);
        length_bound = length_bound + abs(box.centre_offset[k]);
    }
    // Far above what underflow takes from the sums, so that they are 0 instead.
    constexpr float kNothing = 0x1p-100F;
    const Float8 radius =
        mul_add(length_bound,
                Float8(2.0F * frame.padding),
                extent_of_node_slabs(node, box) + extent_of_box_slab(slot, rotated_offset));
    const Float8 gap = max(zero, length_squared - (radius + Float8(kNothing)));
    // In this order nothing overflows.
    const Float8 between = gap / max(length_squared, Float8(kNothing)) * gap;
    // Takes away what rounding the squares and their sums may have added.
    const Float8 lower_bound =
        max(max(in_node_space, in_box_space), between) * Float8(1.0F - 0x1p-18F);
    lower_bound.store(squares);
    return bits(Float8::Mask::first(node.count) & (lower_bound <= Float8(squared_bound)));
}

}  // namespace earshot::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
