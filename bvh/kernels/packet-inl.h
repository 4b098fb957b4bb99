// SPDX-License-Identifier: MIT
//
// Packet traversal of a WideTree: included by kernels once per instruction set, after
// leaf-inl.h.

#include "earshot/bvh/internal/ray_packet.h"

#include <algorithm>
#include <bit>
#include <limits>

#if defined(EARSHOT_BVH_KERNELS_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_PACKET_INL_H
#undef EARSHOT_BVH_KERNELS_PACKET_INL_H
#else
#define EARSHOT_BVH_KERNELS_PACKET_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// The children of a wide node that meet a packet's pyramid: its four sides and two ends.
class PacketFrustum {
public:
    explicit PacketFrustum(const RayPacket& packet) : slack_(set8(-2.0F * packet.slack)) {
        for (std::size_t k = 0; k < 3; ++k) {
            lower_[k] = 2 * packet.axis[k];
            origin_[k] = set8(packet.origin[k]);
        }
        is_forward_ = packet.sign > 0.0F;
        sign_ = set8(packet.sign);
        for (std::size_t k = 0; k < 2; ++k) {
            const float lowest = packet.middle[k] - packet.spread[k];
            const float highest = packet.middle[k] + packet.spread[k];
            min_slope_[k] = set8(lowest);
            max_slope_[k] = set8(highest);
            min_is_positive_[k] = lowest > 0.0F;
            max_is_positive_[k] = highest > 0.0F;
        }
    }

    /// Writes the depths where the pyramid may enter the children to `near`.
    HWY_INLINE Mask8 operator()(const WideNode& node, const Float8& bound, Float8& near) const {
        const Float8 back = load8(node.planes[lower_[2]]) - origin_[2];
        const Float8 front = load8(node.planes[lower_[2] + 1]) - origin_[2];
        const Float8 begin = (is_forward_ ? back : front) * sign_;
        const Float8 end = (is_forward_ ? front : back) * sign_;
        near = maximum(begin + slack_, set8(0.0F));
        Mask8 overlapping = both(at_most(slack_, end), at_most(near, bound));
        for (std::size_t k = 0; k < 2; ++k) {
            // The box's corner that lies max_bound inside each side, and how far it does.
            const Float8 low = load8(node.planes[lower_[k]]) - origin_[k];
            const Float8 high = load8(node.planes[lower_[k] + 1]) - origin_[k];
            const Float8 above =
                subtract_product(min_slope_[k], min_is_positive_[k] ? begin : end, high);
            const Float8 below_max =
                subtract_product(max_slope_[k], max_is_positive_[k] ? end : begin, low);
            overlapping = both(
                overlapping, both(at_most(slack_, above), at_most(slack_, set8(0.0F) - below_max)));
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

/// The triangles of a leaf, with edge functions k0 + kx * slope_x + ky * slope_y.
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
    Float8 x[3], y[3], z[3];
    Float8 size = set8(0.0F);
    const Float8 spread_sum = set8(packet.spread[0] + packet.spread[1]);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * count;
        z[i] = (load8_words(corner + packet.axis[2] * count) - set8(packet.origin[2])) *
               set8(packet.sign);
        x[i] =
            subtract_product(set8(packet.middle[0]),
                             z[i],
                             load8_words(corner + packet.axis[0] * count) - set8(packet.origin[0]));
        y[i] =
            subtract_product(set8(packet.middle[1]),
                             z[i],
                             load8_words(corner + packet.axis[1] * count) - set8(packet.origin[1]));
        size = size + multiply_add(spread_sum, magnitude(z[i]), magnitude(x[i]) + magnitude(y[i]));
        store8(z[i], edges.depth[i]);
    }
    const Float8 error = set8(RayPacket::kEdgeError * slack) * (size + set8(slack));
    const Float8 minus_error = set8(0.0F) - error;
    store8(error, edges.error);
    Float8 min_upper = set8(std::numeric_limits<float>::infinity());
    Float8 max_lower = set8(-std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < 3; ++i) {
        // The edge from corner p to corner q: (x_p - s z_p) (y_q - r z_q) - (y_p - r z_p) (x_q - s
        // z_q), where the term in r s vanishes.
        const std::size_t p = (i + 2) % 3;
        const std::size_t q = (i + 1) % 3;
        const Float8 k0 = subtract_product(y[p], x[q], x[p] * y[q]);
        const Float8 kx = subtract_product(z[p], y[q], y[p] * z[q]);
        const Float8 ky = subtract_product(x[p], z[q], z[p] * x[q]);
        store8(k0, edges.k0[i]);
        store8(kx, edges.kx[i]);
        store8(ky, edges.ky[i]);
        const Float8 range = multiply_add(
            magnitude(kx), set8(packet.spread[0]), magnitude(ky) * set8(packet.spread[1]));
        min_upper = minimum(min_upper, k0 + range);
        max_lower = maximum(max_lower, k0 - range);
    }
    const Float8 min_depth = minimum(minimum(z[0], z[1]), z[2]);
    const Float8 max_depth = maximum(maximum(z[0], z[1]), z[2]);
    edges.depth_error = 3.0F * slack;
    const Float8 depth_error = set8(edges.depth_error);
    const Mask8 sideways = either(at_most(minus_error, min_upper), at_most(max_lower, error));
    const Mask8 along = both(at_most(set8(0.0F) - depth_error, max_depth),
                             at_most(min_depth - depth_error, set8(max_bound)));
    edges.possible = bits(both(sideways, along)) & ((1U << count) - 1U);
}

/// Tests one triangle against all rays. Returns whether a bound was lowered.
HWY_INLINE bool intersect_triangle(const EdgeFunctions& edges,
                                   std::size_t k,
                                   std::uint32_t triangle,
                                   const geometry::MeshView& mesh,
                                   RayPacket& packet) {
    const Float8 k0[3] = {set8(edges.k0[0][k]), set8(edges.k0[1][k]), set8(edges.k0[2][k])};
    const Float8 kx[3] = {set8(edges.kx[0][k]), set8(edges.kx[1][k]), set8(edges.kx[2][k])};
    const Float8 ky[3] = {set8(edges.ky[0][k]), set8(edges.ky[1][k]), set8(edges.ky[2][k])};
    const Float8 error = set8(edges.error[k]);
    const Float8 minus_error = set8(-edges.error[k]);
    bool is_lowered = false;
    for (std::size_t first = 0; first < packet.count(); first += 8) {
        const Float8 slope_x = load8(packet.slope_x + first);
        const Float8 slope_y = load8(packet.slope_y + first);
        const Float8 u = multiply_add(ky[0], slope_y, multiply_add(kx[0], slope_x, k0[0]));
        const Float8 v = multiply_add(ky[1], slope_y, multiply_add(kx[1], slope_x, k0[1]));
        const Float8 w = multiply_add(ky[2], slope_y, multiply_add(kx[2], slope_x, k0[2]));
        const Float8 lowest = minimum(minimum(u, v), w);
        const Float8 highest = maximum(maximum(u, v), w);
        const Mask8 maybe = either(at_most(minus_error, lowest), at_most(highest, error));
        if (bits(maybe) == 0) {
            continue;
        }
        // The bounds of the depth, as intersect() has them.
        const float depths[3] = {edges.depth[0][k], edges.depth[1][k], edges.depth[2][k]};
        const float low = std::min({depths[0], depths[1], depths[2]});
        const float high = std::max({depths[0], depths[1], depths[2]});
        const Float8 min_depth = set8(low);
        const Float8 max_depth = set8(high);
        const Float8 sum = (u + v) + w;
        const Float8 relative_error = set8(12.0F) * error / magnitude(sum);
        const Float8 weighted =
            multiply_add(
                u, set8(depths[0]), multiply_add(v, set8(depths[1]), w * set8(depths[2]))) /
            sum;
        const Mask8 known = below(relative_error, set8(1.0F));
        const Float8 middle = minimum(maximum(weighted, min_depth), max_depth);
        const Float8 spread = relative_error * set8(high - low);
        const Float8 depth_error = set8(edges.depth_error);
        const Float8 from =
            choose(known, maximum(middle - spread, min_depth), min_depth) - depth_error;
        const Float8 to =
            choose(known, minimum(middle + spread, max_depth), max_depth) + depth_error;
        const Float8 bound = load8(packet.bound + first);
        const Mask8 certain =
            both(both(known, either(below(error, lowest), below(highest, minus_error))),
                 both(at_most(set8(0.0F), from), at_most(to, load8(packet.inside + first))));
        const Float8 lowered = choose(certain, minimum(bound, to), bound);
        is_lowered = is_lowered || bits(below(lowered, bound)) != 0;
        store8(lowered, packet.bound + first);
        std::uint32_t remaining =
            bits(both(maybe, both(at_most(from, lowered), at_most(set8(0.0F), to))));
        if (remaining != 0) {
            alignas(32) float near[8];
            store8(from, near);
            for (; remaining != 0; remaining &= remaining - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
                packet.add(mesh, first + lane, triangle, near[lane]);
            }
        }
    }
    return is_lowered;
}

HWY_INLINE float largest_bound(const RayPacket& packet) {
    Float8 highest = load8(packet.bound);
    for (std::size_t first = 8; first < packet.count(); first += 8) {
        highest = maximum(highest, load8(packet.bound + first));
    }
    return largest(highest);
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
            const Mask8 overlapping = cull(node, set8(max_bound), near);
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
