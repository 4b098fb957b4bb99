// SPDX-License-Identifier: MIT
//
// One box against up to eight of another space, for kernels that are compiled once per instruction
// set (see base/wide_float.h). All tests err to the side of contact.

#include "earshot/base/wide_float.h"
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

#if defined(EARSHOT_COLLISION_BOX_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_COLLISION_BOX_STEPS_INL_H
#undef EARSHOT_COLLISION_BOX_STEPS_INL_H
#else
#define EARSHOT_COLLISION_BOX_STEPS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::collision::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the wide types

// Of each pair on the way down, through two trees, all children but one wait.
inline constexpr std::size_t kMostWaiting = 2 * (BoxNode::kWidth - 1) * (bvh::kMaxDepth + 2) + 1;

HWY_INLINE std::uint32_t child_of(std::span<const BoxNode> nodes, std::uint32_t place) {
    return nodes[place / 8].child[place % 8];
}

/// One box of a node.
struct Slot {
    float centre[3], half[3];
    float normal[3], slab_centre, slab_half;
    std::uint32_t child;

    HWY_INLINE Slot(std::span<const BoxNode> nodes, std::uint32_t place) {
        const BoxNode& node = nodes[place / 8];
        const std::uint32_t slot = place % 8;
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

/// Whether of a pair a is opened: the larger, if it is no triangle.
HWY_INLINE bool is_opened_first(const Slot& a, const Slot& b) {
    return b.is_triangle() || (!a.is_triangle() && a.size() >= b.size());
}

template <typename Visit>
HWY_INLINE void for_each_bit(std::uint32_t mask, Visit&& visit) {
    for (; mask != 0; mask &= mask - 1) {
        visit(static_cast<std::uint32_t>(std::countr_zero(mask)));
    }
}

/// A box as guest of another space, and where it lies from each of a node's boxes.
struct Guest {
    Float8 apart[3];  // of centres, along the host's axes
    Float8 half[3];   // of the hosts
    float reach[3];   // of the guest along the host's axes, padded

    HWY_INLINE Guest(const BoxNode& node, const Slot& guest, const GuestFrame& frame) {
        for (std::size_t k = 0; k < 3; ++k) {
            float centre = frame.origin[k];
            float sum = frame.padding;
            for (std::size_t j = 0; j < 3; ++j) {
                centre += frame.turn[k][j] * guest.centre[j];
                sum += frame.magnitude[k][j] * guest.half[j];
            }
            reach[k] = sum;
            apart[k] = set8(centre) - load8(node.centre[k]);
            half[k] = load8(node.half[k]);
        }
    }

    /// Component of the distance of centres along the guest's axis j.
    HWY_INLINE Float8 along(const GuestFrame& frame, std::size_t j) const {
        Float8 sum = apart[0] * set8(frame.turn[0][j]);
        sum = multiply_add(apart[1], set8(frame.turn[1][j]), sum);
        return multiply_add(apart[2], set8(frame.turn[2][j]), sum);
    }
    /// How far hosts and guest together reach along it.
    HWY_INLINE Float8 reach_along(const Slot& guest, const GuestFrame& frame, std::size_t j) const {
        Float8 sum = set8(guest.half[j] + frame.padding);
        for (std::size_t k = 0; k < 3; ++k) {
            sum = multiply_add(half[k], set8(frame.magnitude[k][j]), sum);
        }
        return sum;
    }
};

/// Whether no slab parts its owner from the other's box.
HWY_INLINE Mask8 slabs_overlap(const BoxNode& node,
                               const Slot& slot,
                               const Guest& guest,
                               const GuestFrame& frame) {
    Float8 on_host = set8(0.0F) - load8(node.slab_centre);
    Float8 host_reach = load8(node.slab_half) + set8(frame.padding);
    Float8 on_guest = set8(slot.slab_centre);
    Float8 guest_reach = set8(slot.slab_half + frame.padding);
    for (std::size_t k = 0; k < 3; ++k) {
        on_host = multiply_add(guest.apart[k], load8(node.normal[k]), on_host);
        const float normal = frame.turn[k][0] * slot.normal[0] + frame.turn[k][1] * slot.normal[1] +
                             frame.turn[k][2] * slot.normal[2];
        on_guest = multiply_add(guest.apart[k], set8(normal), on_guest);
        guest_reach = multiply_add(guest.half[k], set8(std::abs(normal)), guest_reach);
        Float8 along = load8(node.normal[0]) * set8(frame.turn[0][k]);
        along = multiply_add(load8(node.normal[1]), set8(frame.turn[1][k]), along);
        along = multiply_add(load8(node.normal[2]), set8(frame.turn[2][k]), along);
        host_reach = multiply_add(magnitude(along), set8(slot.half[k]), host_reach);
    }
    return both(at_most(magnitude(on_host), host_reach), at_most(magnitude(on_guest), guest_reach));
}

/// Which boxes of a node may overlap the guest: bit i stands for slot i. Gottschalk, Lin and
/// Manocha 1996, section 5, but for the products of edges, which cull little after the slabs.
HWY_INLINE std::uint32_t overlapping(const BoxNode& node,
                                     const Slot& slot,
                                     const GuestFrame& frame,
                                     bool is_aligned) {
    const Guest guest(node, slot, frame);
    Mask8 mask = first_lanes(node.count);
    for (std::size_t k = 0; k < 3; ++k) {
        mask = both(mask, at_most(magnitude(guest.apart[k]), guest.half[k] + set8(guest.reach[k])));
    }
    if (is_aligned || bits(mask) == 0) {
        return bits(mask);
    }
    for (std::size_t j = 0; j < 3; ++j) {
        mask = both(mask,
                    at_most(magnitude(guest.along(frame, j)), guest.reach_along(slot, frame, j)));
    }
    mask = both(mask, slabs_overlap(node, slot, guest, frame));
    return bits(mask);
}

/// A triangle as guest: its corners and its plane tell more than its box.
struct GuestTriangle {
    float corner[3][3];  // of each corner the coordinates along the host's axes
    float normal[3];
    float slack;  // of the corners about the plane

    HWY_INLINE GuestTriangle(const Slot& slot,
                             std::span<const Corners> corners,
                             const GuestFrame& frame) {
        const Corners& own = corners[slot.child & ~kTriangleFlag];
        for (int k = 0; k < 3; ++k) {
            const float* turn = frame.turn[k];
            for (std::size_t i = 0; i < 3; ++i) {
                const geometry::Vec3& p = own[i];
                corner[i][k] = frame.origin[k] + (turn[0] * static_cast<float>(p.x) +
                                                  turn[1] * static_cast<float>(p.y) +
                                                  turn[2] * static_cast<float>(p.z));
            }
            normal[k] =
                turn[0] * slot.normal[0] + turn[1] * slot.normal[1] + turn[2] * slot.normal[2];
        }
        slack = 2.0F * slot.slab_half + frame.padding;
    }
};

/// Which boxes of a node may overlap the triangle, and so may what is in their slabs: the host's
/// axes and slabs, the guest's plane.
HWY_INLINE std::uint32_t overlapping(const BoxNode& node,
                                     const GuestTriangle& guest,
                                     float padding) {
    Mask8 mask = first_lanes(node.count);
    Float8 on_guest = set8(0.0F);
    Float8 guest_reach = set8(guest.slack);
    Float8 height[3];
    for (Float8& each : height) {
        each = set8(0.0F) - load8(node.slab_centre);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 centre = load8(node.centre[k]);
        const Float8 half = load8(node.half[k]);
        const Float8 normal = load8(node.normal[k]);
        const Float8 p0 = set8(guest.corner[0][k]) - centre;
        const Float8 p1 = set8(guest.corner[1][k]) - centre;
        const Float8 p2 = set8(guest.corner[2][k]) - centre;
        const Float8 reach = half + set8(padding);
        mask = both(mask, at_most(minimum(minimum(p0, p1), p2), reach));
        mask = both(mask, at_most(set8(0.0F) - reach, maximum(maximum(p0, p1), p2)));
        height[0] = multiply_add(p0, normal, height[0]);
        height[1] = multiply_add(p1, normal, height[1]);
        height[2] = multiply_add(p2, normal, height[2]);
        on_guest = multiply_add(p0, set8(guest.normal[k]), on_guest);
        guest_reach = multiply_add(half, set8(std::abs(guest.normal[k])), guest_reach);
    }
    const Float8 reach = load8(node.slab_half) + set8(padding);
    mask = both(mask, at_most(minimum(minimum(height[0], height[1]), height[2]), reach));
    mask =
        both(mask, at_most(set8(0.0F) - reach, maximum(maximum(height[0], height[1]), height[2])));
    return bits(both(mask, at_most(magnitude(on_guest), guest_reach)));
}

/// The host's slab along a direction that differs for each: how far what is in it reaches that way
/// from the centre of its box. The direction is taken apart into a multiple of the slab's normal
/// and a rest, for which the box answers.
HWY_INLINE Float8 reach_of_hosts(const BoxNode& node, const Guest& guest) {
    const Float8 share = multiply_add(
        guest.apart[0],
        load8(node.normal[0]),
        multiply_add(
            guest.apart[1], load8(node.normal[1]), guest.apart[2] * load8(node.normal[2])));
    Float8 reach =
        multiply_add(share, load8(node.slab_centre), magnitude(share) * load8(node.slab_half));
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 rest = subtract_product(share, load8(node.normal[k]), guest.apart[k]);
        reach = multiply_add(magnitude(rest), guest.half[k], reach);
    }
    return reach;
}

/// The guest's, the other way; `apart` are the components of the direction along its axes.
HWY_INLINE Float8 reach_of_guest(const Slot& slot, const Float8 (&apart)[3]) {
    const Float8 share =
        multiply_add(apart[0],
                     set8(slot.normal[0]),
                     multiply_add(apart[1], set8(slot.normal[1]), apart[2] * set8(slot.normal[2])));
    Float8 reach =
        subtract_product(share, set8(slot.slab_centre), magnitude(share) * set8(slot.slab_half));
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 rest = subtract_product(share, set8(slot.normal[k]), apart[k]);
        reach = multiply_add(magnitude(rest), set8(slot.half[k]), reach);
    }
    return reach;
}

/// Which boxes of a node may be within a distance of the guest, given its square, and lower bounds
/// of their squared distances: the distance along the host's axes, that along the guest's, and the
/// gap along the line of centres.
HWY_INLINE std::uint32_t within(const BoxNode& node,
                                const Slot& slot,
                                const GuestFrame& frame,
                                float squared_bound,
                                float* squares) {
    const Guest guest(node, slot, frame);
    const Float8 zero = set8(0.0F);
    Float8 in_host = zero;
    Float8 in_guest = zero;
    Float8 length_squared = zero;
    Float8 length_bound = zero;
    Float8 turned[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const Float8 gap =
            maximum(zero, magnitude(guest.apart[k]) - (guest.half[k] + set8(guest.reach[k])));
        in_host = multiply_add(gap, gap, in_host);
        turned[k] = guest.along(frame, k);
        const Float8 own = maximum(zero, magnitude(turned[k]) - guest.reach_along(slot, frame, k));
        in_guest = multiply_add(own, own, in_guest);
        length_squared = multiply_add(guest.apart[k], guest.apart[k], length_squared);
        length_bound = length_bound + magnitude(guest.apart[k]);
    }
    // Far above what underflow takes from the sums, so that they are 0 instead.
    constexpr float kNothing = 0x1p-100F;
    const Float8 reach = multiply_add(length_bound,
                                      set8(2.0F * frame.padding),
                                      reach_of_hosts(node, guest) + reach_of_guest(slot, turned));
    const Float8 gap = maximum(zero, length_squared - (reach + set8(kNothing)));
    // In this order nothing overflows.
    const Float8 between = gap / maximum(length_squared, set8(kNothing)) * gap;
    // Takes away what rounding the squares and their sums may have added.
    const Float8 least = maximum(maximum(in_host, in_guest), between) * set8(1.0F - 0x1p-18F);
    store8(least, squares);
    return bits(both(first_lanes(node.count), at_most(least, set8(squared_bound))));
}

}  // namespace earshot::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
