// SPDX-License-Identifier: MIT
//
// Packet traversal of a WideTree (Reshetov, Soupikov and Hurley 2005), compiled once per
// instruction set.

#include "earshot/bvh/internal/ray_packet.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/kernels/node-inl.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#if defined(EARSHOT_BVH_KERNELS_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_PACKET_INL_H
#undef EARSHOT_BVH_KERNELS_PACKET_INL_H
#else
#define EARSHOT_BVH_KERNELS_PACKET_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

// A packet from its common origin O: z is the depth along the rays' largest component, x and y are
// the other axes; slopes are x / z and y / z.
//
//    x |               .'  x = max_slope z
//      |           .' +-------+
//      |       .'     |  box  |   PacketFrustum: a box is outside if its corner farthest inside a
//      |   .'         +-------*   side, here * of the lower one, is outside, or all its depths are.
//      O'----------------------> z
//        '.        q
//          '.     /|              EdgeFunctions: as all rays start in O, the edge function of an
//            '.  / |              edge p q is (p x q) . (slope_x, slope_y, 1), linear in the
//            slopes.
//              '/--+              Corners are sheared so that the central ray runs along z.
//              p '.
//                  '.  x = min_slope z

/// The frustum of a packet, four sides and two ends, against the children of a wide node (Reshetov,
/// Soupikov and Hurley 2005).
class PacketFrustum {
public:
    explicit PacketFrustum(const RayPacket& packet) : slack_(Float8(-packet.plane_error)) {
        for (std::size_t k = 0; k < 3; ++k) {
            lower_[k] = 2 * packet.axis[k];
            origin_[k] = Float8(packet.origin[k]);
        }
        is_forward_ = packet.sign > 0.0F;
        sign_ = Float8(packet.sign);
        for (std::size_t k = 0; k < 2; ++k) {
            const float lowest = packet.middle[k] - packet.spread[k];
            const float highest = packet.middle[k] + packet.spread[k];
            min_slope_[k] = Float8(lowest);
            max_slope_[k] = Float8(highest);
            min_is_positive_[k] = lowest > 0.0F;
            max_is_positive_[k] = highest > 0.0F;
        }
    }

    /// The depths where the packet may enter the children; before the origin it leaves those that
    /// it does not overlap.
    HWY_INLINE SlabIntervals operator()(const WideNode& node, const Float8& bound) const {
        const Float8 back = Float8::load(node.planes[lower_[2]]) - origin_[2];
        const Float8 front = Float8::load(node.planes[lower_[2] + 1]) - origin_[2];
        const Float8 begin = (is_forward_ ? back : front) * sign_;
        const Float8 end = (is_forward_ ? front : back) * sign_;
        const Float8 near = max(begin + slack_, Float8(0.0F));
        Float8::Mask overlapping = (slack_ <= end) & (near <= bound);
        for (std::size_t k = 0; k < 2; ++k) {
            // The box's corner that lies farthest inside each side, and how far it does.
            const Float8 low = Float8::load(node.planes[lower_[k]]) - origin_[k];
            const Float8 high = Float8::load(node.planes[lower_[k] + 1]) - origin_[k];
            const Float8 above =
                neg_mul_add(min_slope_[k], min_is_positive_[k] ? begin : end, high);
            const Float8 below_max =
                neg_mul_add(max_slope_[k], max_is_positive_[k] ? end : begin, low);
            overlapping = overlapping & (slack_ <= above) & (slack_ <= Float8(0.0F) - below_max);
        }
        return {near, select(overlapping, bound, Float8(-1.0F))};
    }

private:
    Float8 slack_, sign_;
    Float8 origin_[3], min_slope_[2], max_slope_[2];
    std::uint32_t lower_[3];
    bool is_forward_;
    bool min_is_positive_[2], max_is_positive_[2];
};

/// As ProvenTerms, of a packet, whose edge functions have more terms and slopes more roundings.
struct PacketTerms : ProvenTerms {
    static constexpr float kDepth = 12.0F * kRoundoff;
    static constexpr float kEdge = 2.0F;
};

/// The triangles of a leaf, with edge functions k0 + kx * slope_x + ky * slope_y (Davidovic et al.
/// 2012).
struct EdgeFunctions {
    std::uint32_t possible;  // bit per triangle: a ray of the packet may hit it
    alignas(32) float k0[3][8];
    alignas(32) float kx[3][8];
    alignas(32) float ky[3][8];
    alignas(32) float depth[3][8];  // of the corners
    alignas(32) float min_depth[8];
    alignas(32) float max_depth[8];
    alignas(32) float error[8];   // by how much an edge function may be wrong
    alignas(32) float margin[8];  // and a depth
};

template <typename Terms = PacketTerms>
HWY_INLINE void set_up_edge_functions(const LeafTriangles& leaf,
                                      const RayPacket& packet,
                                      float max_bound,
                                      EdgeFunctions& edges) {
    const std::size_t count = leaf.count;
    const Float8 corner_error = Float8(leaf.corner_error(packet.corner_error));
    // Corners from the origin, sheared along the central ray.
    Float8 x[3], y[3], z[3];
    const auto from_origin = [&](const std::uint32_t* corner, std::size_t k) {
        return (load_bits(corner + packet.axis[k] * count) - Float8(packet.origin[k])) -
               Float8(packet.origin_rest[k]);
    };
    Float8 size = Float8(0.0F);
    const Float8 spread_sum = Float8(packet.spread[0] + packet.spread[1]);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * count;
        z[i] = from_origin(corner, 2) * Float8(packet.sign);
        x[i] = neg_mul_add(Float8(packet.middle[0]), z[i], from_origin(corner, 0));
        y[i] = neg_mul_add(Float8(packet.middle[1]), z[i], from_origin(corner, 1));
        size = size + mul_add(spread_sum, abs(z[i]), abs(x[i]) + abs(y[i]));
        z[i].store(edges.depth[i]);
    }
    const Float8 reach = max(max(abs(z[0]), abs(z[1])), abs(z[2]));
    const Float8 sheared_error =
        mul_add(reach,
                Float8(Terms::kDepth),
                mul_add(size, Float8(Terms::kLateral), corner_error + corner_error));
    const Float8 error = Float8(Terms::kEdge) * sheared_error * size;
    const Float8 margin = mul_add(reach, Float8(Terms::kDistance), corner_error);
    error.store(edges.error);
    margin.store(edges.margin);
    // Edge functions, and the ranges of their values over the packet's slopes (interval
    // arithmetic).
    Float8 min_upper = Float8(std::numeric_limits<float>::infinity());
    Float8 max_lower = Float8(-std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < 3; ++i) {
        // The edge from corner p to corner q: (x_p - s z_p) (y_q - r z_q) - (y_p - r z_p) (x_q - s
        // z_q), where the term in r s vanishes.
        const std::size_t p = (i + 2) % 3;
        const std::size_t q = (i + 1) % 3;
        const Float8 k0 = neg_mul_add(y[p], x[q], x[p] * y[q]);
        const Float8 kx = neg_mul_add(z[p], y[q], y[p] * z[q]);
        const Float8 ky = neg_mul_add(x[p], z[q], z[p] * x[q]);
        k0.store(edges.k0[i]);
        kx.store(edges.kx[i]);
        ky.store(edges.ky[i]);
        const Float8 range =
            mul_add(abs(kx), Float8(packet.spread[0]), abs(ky) * Float8(packet.spread[1]));
        min_upper = min(min_upper, k0 + range);
        max_lower = max(max_lower, k0 - range);
    }
    // A triangle is out for the whole packet if two of its edge functions have opposite signs for
    // sure, or if it lies behind the origin or beyond every ray's bound.
    const Float8 min_depth = min(min(z[0], z[1]), z[2]);
    const Float8 max_depth = max(max(z[0], z[1]), z[2]);
    min_depth.store(edges.min_depth);
    max_depth.store(edges.max_depth);
    const Float8::Mask sideways = (-error <= min_upper) | (max_lower <= error);
    const Float8::Mask along = (-margin <= max_depth) & (min_depth - margin <= Float8(max_bound));
    edges.possible = bits(sideways & along & Float8::Mask::first(count));
}

/// Tests one triangle against all rays. Returns whether a bound was lowered. Each ray keeps one
/// candidate; spill(ray) is called where a second one is possible.
template <typename Spill>
HWY_INLINE bool intersect_triangle(const EdgeFunctions& edges,
                                   std::size_t k,
                                   std::uint32_t triangle,
                                   RayPacket& packet,
                                   const Spill& spill) {
    using Rays = Float16;
    static_assert(Rays::kCount == RayPacket::kGroup);
    const Rays zero = Rays(0.0F);
    const Rays error = Rays(edges.error[k]);
    bool is_lowered = false;
    for (std::size_t first = 0; first < packet.count; first += RayPacket::kGroup) {
        const Rays slope_x = Rays::load(packet.slope_x + first);
        const Rays slope_y = Rays::load(packet.slope_y + first);
        const auto edge_function = [&](std::size_t i) {
            return mul_add(Rays(edges.ky[i][k]),
                           slope_y,
                           mul_add(Rays(edges.kx[i][k]), slope_x, Rays(edges.k0[i][k])));
        };
        const Rays u = edge_function(0);
        const Rays v = edge_function(1);
        const Rays w = edge_function(2);
        const Rays lowest = min(min(u, v), w);
        const Rays highest = max(max(u, v), w);
        const Rays::Mask maybe = (-error <= lowest) | (highest <= error);
        if (!any(maybe)) {
            continue;
        }
        // The bounds of the depth, as EdgeTest has them.
        const Rays min_depth = Rays(edges.min_depth[k]);
        const Rays max_depth = Rays(edges.max_depth[k]);
        const Rays inverse_sum = Rays(1.0F) / ((u + v) + w);
        const Rays relative_error = error * abs(inverse_sum);
        const Rays::Mask known = relative_error < Rays(ProvenTerms::kMaxKnown);
        const Rays weighted =
            mul_add(u,
                    Rays(edges.depth[0][k]),
                    mul_add(v, Rays(edges.depth[1][k]), w * Rays(edges.depth[2][k]))) *
            inverse_sum;
        const Rays spread = Rays(ProvenTerms::kSpread) * relative_error * (max_depth - min_depth);
        const Rays margin = Rays(edges.margin[k]);
        const Rays from = select(known, max(weighted - spread, min_depth), min_depth) - margin;
        const Rays to = select(known, min(weighted + spread, max_depth), max_depth) + margin;
        const Rays bound = Rays::load(packet.bound + first);
        const Rays::Mask certain = known & ((error < lowest) | (highest < -error)) &
                                   (zero <= from) & (to <= Rays::load(packet.inside + first));
        const Rays lowered = select(certain, min(bound, to), bound);
        is_lowered = is_lowered || any(lowered < bound);
        lowered.store(packet.bound + first);
        // A candidate takes the place of one that can no longer be the closest.
        const Rays::Mask is_candidate = maybe & (from <= lowered) & (zero <= to);
        const Rays before = Rays::load(packet.candidate_near + first);
        const Rays::Mask replaces = is_candidate & (lowered < before);
        select(replaces, from, before).store(packet.candidate_near + first);
        assign(replaces, triangle, packet.candidate + first);
        std::uint32_t remaining = bits(and_not(is_candidate, replaces));
        for (; remaining != 0; remaining &= remaining - 1) {
            spill(first + static_cast<std::size_t>(std::countr_zero(remaining)));
        }
    }
    return is_lowered;
}

HWY_INLINE float largest_bound(const RayPacket& packet) {
    Float16 highest = Float16::load(packet.bound);
    for (std::size_t first = RayPacket::kGroup; first < packet.count; first += RayPacket::kGroup) {
        highest = max(highest, Float16::load(packet.bound + first));
    }
    return reduce_max(highest);
}

/// Finds for every ray of the packet a candidate for its closest hit; further ones are given to
/// spill(ray, triangle). False: the packet meets more leaves than it has rays, which are then
/// faster on their own.
template <typename Spill>
HWY_INLINE bool traverse_packet(const WideTree& tree, RayPacket& packet, const Spill& spill) {
    const PacketFrustum cull(packet);
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    float max_bound = largest_bound(packet);
    std::size_t leaf_budget = packet.count;
    bool has_next = true;
    while (has_next) {
        if (!is_leaf(stack.current)) {
            const WideNode& node = nodes[stack.current];
            stack.push(cull(node, Float8(max_bound)), node, packet.order_shift);
        } else {
            if (leaf_budget-- == 0) {
                return false;
            }
            DecodeBuffer buffer;
            const LeafTriangles leaf = decode_leaf(tree, stack.current, buffer);
            EdgeFunctions edges;
            set_up_edge_functions(leaf, packet, max_bound, edges);
            bool is_lowered = false;
            for (std::uint32_t remaining = edges.possible; remaining != 0;
                 remaining &= remaining - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(remaining));
                const std::uint32_t triangle = leaf.triangles()[k];
                is_lowered |= intersect_triangle(
                    edges, k, triangle, packet, [&](std::size_t ray) { spill(ray, triangle); });
            }
            max_bound = is_lowered ? largest_bound(packet) : max_bound;
        }
        has_next = stack.pop(max_bound);
    }
    return true;
}

/// Calls visit(ray, triangle) for the candidates that may be the closest hits.
template <typename Visit>
HWY_INLINE void for_each_candidate(const RayPacket& packet, const Visit& visit) {
    for (std::size_t first = 0; first < packet.count; first += RayPacket::kGroup) {
        const Float16 near = Float16::load(packet.candidate_near + first);
        std::uint32_t remaining = bits(near <= Float16::load(packet.bound + first));
        for (; remaining != 0; remaining &= remaining - 1) {
            const std::size_t ray = first + static_cast<std::size_t>(std::countr_zero(remaining));
            visit(ray, packet.candidate[ray]);
        }
    }
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
