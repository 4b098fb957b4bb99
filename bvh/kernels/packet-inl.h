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
    explicit PacketFrustum(const RayPacket& packet) : slack_(Float8(-2.0F * packet.slack)) {
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

    /// Writes the depths where the packet may enter the children to `near`.
    HWY_INLINE Float8::Mask operator()(const WideNode& node,
                                       const Float8& bound,
                                       Float8& near) const {
        const Float8 back = Float8::load(node.planes[lower_[2]]) - origin_[2];
        const Float8 front = Float8::load(node.planes[lower_[2] + 1]) - origin_[2];
        const Float8 begin = (is_forward_ ? back : front) * sign_;
        const Float8 end = (is_forward_ ? front : back) * sign_;
        near = max(begin + slack_, Float8(0.0F));
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
        return overlapping;
    }

private:
    Float8 slack_, sign_;
    Float8 origin_[3], min_slope_[2], max_slope_[2];
    std::uint32_t lower_[3];
    bool is_forward_;
    bool min_is_positive_[2], max_is_positive_[2];
};

/// The triangles of a leaf, with edge functions k0 + kx * slope_x + ky * slope_y (Davidovic et al.
/// 2012).
struct EdgeFunctions {
    std::uint32_t possible;  // bit per triangle: a ray of the packet may hit it
    alignas(32) float k0[3][8];
    alignas(32) float kx[3][8];
    alignas(32) float ky[3][8];
    alignas(32) float depth[3][8];  // of the corners
    alignas(32) float error[8];     // by how much an edge function may be wrong
    float depth_error;              // and a depth
};

HWY_INLINE void set_up_edge_functions(const LeafTriangles& leaf,
                                      const RayPacket& packet,
                                      float max_bound,
                                      EdgeFunctions& edges) {
    const std::size_t count = leaf.count;
    const float slack = leaf.slack(packet.slack);
    // Corners from the origin, sheared along the central ray.
    Float8 x[3], y[3], z[3];
    Float8 size = Float8(0.0F);
    const Float8 spread_sum = Float8(packet.spread[0] + packet.spread[1]);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * count;
        z[i] = (load_bits(corner + packet.axis[2] * count) - Float8(packet.origin[2])) *
               Float8(packet.sign);
        x[i] = neg_mul_add(Float8(packet.middle[0]),
                           z[i],
                           load_bits(corner + packet.axis[0] * count) - Float8(packet.origin[0]));
        y[i] = neg_mul_add(Float8(packet.middle[1]),
                           z[i],
                           load_bits(corner + packet.axis[1] * count) - Float8(packet.origin[1]));
        size = size + mul_add(spread_sum, abs(z[i]), abs(x[i]) + abs(y[i]));
        z[i].store(edges.depth[i]);
    }
    // The error bound of every edge function, as FloatRay derives it.
    const Float8 error = Float8(RayPacket::kEdgeError * slack) * (size + Float8(slack));
    const Float8 minus_error = Float8(0.0F) - error;
    error.store(edges.error);
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
    edges.depth_error = 3.0F * slack;
    const Float8 depth_error = Float8(edges.depth_error);
    const Float8::Mask sideways = (minus_error <= min_upper) | (max_lower <= error);
    const Float8::Mask along =
        (Float8(0.0F) - depth_error <= max_depth) & (min_depth - depth_error <= Float8(max_bound));
    edges.possible = bits(sideways & along) & ((1U << count) - 1U);
}

/// Tests one triangle against all rays. Returns whether a bound was lowered.
HWY_INLINE bool intersect_triangle(const EdgeFunctions& edges,
                                   std::size_t k,
                                   std::uint32_t triangle,
                                   const geometry::MeshView& mesh,
                                   RayPacket& packet) {
    const Float8 k0[3] = {Float8(edges.k0[0][k]), Float8(edges.k0[1][k]), Float8(edges.k0[2][k])};
    const Float8 kx[3] = {Float8(edges.kx[0][k]), Float8(edges.kx[1][k]), Float8(edges.kx[2][k])};
    const Float8 ky[3] = {Float8(edges.ky[0][k]), Float8(edges.ky[1][k]), Float8(edges.ky[2][k])};
    const Float8 error = Float8(edges.error[k]);
    const Float8 minus_error = Float8(-edges.error[k]);
    bool is_lowered = false;
    for (std::size_t first = 0; first < packet.count(); first += 8) {
        const Float8 slope_x = Float8::load(packet.slope_x + first);
        const Float8 slope_y = Float8::load(packet.slope_y + first);
        const Float8 u = mul_add(ky[0], slope_y, mul_add(kx[0], slope_x, k0[0]));
        const Float8 v = mul_add(ky[1], slope_y, mul_add(kx[1], slope_x, k0[1]));
        const Float8 w = mul_add(ky[2], slope_y, mul_add(kx[2], slope_x, k0[2]));
        const Float8 lowest = min(min(u, v), w);
        const Float8 highest = max(max(u, v), w);
        const Float8::Mask maybe = (minus_error <= lowest) | (highest <= error);
        if (bits(maybe) == 0) {
            continue;
        }
        // The bounds of the depth, as intersect() has them.
        const float depths[3] = {edges.depth[0][k], edges.depth[1][k], edges.depth[2][k]};
        const float low = std::min({depths[0], depths[1], depths[2]});
        const float high = std::max({depths[0], depths[1], depths[2]});
        const Float8 min_depth = Float8(low);
        const Float8 max_depth = Float8(high);
        const Float8 sum = (u + v) + w;
        const Float8 relative_error = Float8(12.0F) * error / abs(sum);
        const Float8 weighted =
            mul_add(u, Float8(depths[0]), mul_add(v, Float8(depths[1]), w * Float8(depths[2]))) /
            sum;
        const Float8::Mask known = relative_error < Float8(1.0F);
        const Float8 middle = min(max(weighted, min_depth), max_depth);
        const Float8 spread = relative_error * Float8(high - low);
        const Float8 depth_error = Float8(edges.depth_error);
        const Float8 from = select(known, max(middle - spread, min_depth), min_depth) - depth_error;
        const Float8 to = select(known, min(middle + spread, max_depth), max_depth) + depth_error;
        const Float8 bound = Float8::load(packet.bound + first);
        const Float8::Mask certain = known & ((error < lowest) | (highest < minus_error)) &
                                     (Float8(0.0F) <= from) &
                                     (to <= Float8::load(packet.inside + first));
        const Float8 lowered = select(certain, min(bound, to), bound);
        is_lowered = is_lowered || bits(lowered < bound) != 0;
        lowered.store(packet.bound + first);
        std::uint32_t remaining = bits(maybe & (from <= lowered) & (Float8(0.0F) <= to));
        if (remaining != 0) {
            alignas(32) float near[8];
            from.store(near);
            for (; remaining != 0; remaining &= remaining - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
                packet.add(mesh, first + lane, triangle, near[lane]);
            }
        }
    }
    return is_lowered;
}

HWY_INLINE float largest_bound(const RayPacket& packet) {
    Float8 highest = Float8::load(packet.bound);
    for (std::size_t first = 8; first < packet.count(); first += 8) {
        highest = max(highest, Float8::load(packet.bound + first));
    }
    return reduce_max(highest);
}

/// Adds to every ray of the packet what it may hit; the last of it is still to be decided. False:
/// the packet meets more leaves than it has rays, which are then faster on their own.
HWY_INLINE bool traverse_packet(const WideTree& tree,
                                const geometry::MeshView& mesh,
                                RayPacket& packet) {
    const PacketFrustum cull(packet);
    const WideNode* nodes = tree.nodes().data();
    TraversalStack stack;
    float max_bound = largest_bound(packet);
    std::size_t leaf_budget = packet.count();
    bool has_next = true;
    while (has_next) {
        if (!is_leaf(stack.current)) {
            const WideNode& node = nodes[stack.current];
            Float8 near;
            const Float8::Mask overlapping = cull(node, Float8(max_bound), near);
            stack.push(near, overlapping, node, packet.order_shift);
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
                is_lowered |= intersect_triangle(edges, k, leaf.triangle(k), mesh, packet);
            }
            max_bound = is_lowered ? largest_bound(packet) : max_bound;
        }
        has_next = stack.pop(max_bound);
    }
    return true;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
