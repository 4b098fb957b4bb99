// SPDX-License-Identifier: MIT
//
// A bundle's way through a WideTree: included by kernels once per instruction set, after
// wide_steps-inl.h.

#include "earshot/bvh/internal/bundle.h"

#include <algorithm>
#include <bit>
#include <limits>

#if defined(EARSHOT_BVH_BUNDLE_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_BUNDLE_STEPS_INL_H
#undef EARSHOT_BVH_BUNDLE_STEPS_INL_H
#else
#define EARSHOT_BVH_BUNDLE_STEPS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// The children of a wide node that meet a bundle's pyramid: its four sides and two ends.
class PyramidCull {
public:
    explicit PyramidCull(const Bundle& bundle) : slack_(set8(-2.0F * bundle.slack)) {
        for (std::size_t k = 0; k < 3; ++k) {
            lower_[k] = 2 * bundle.axis[k];
            origin_[k] = set8(bundle.origin[k]);
        }
        is_forward_ = bundle.sign > 0.0F;
        sign_ = set8(bundle.sign);
        for (std::size_t k = 0; k < 2; ++k) {
            const float least = bundle.middle[k] - bundle.spread[k];
            const float most = bundle.middle[k] + bundle.spread[k];
            least_[k] = set8(least);
            most_[k] = set8(most);
            least_is_positive_[k] = least > 0.0F;
            most_is_positive_[k] = most > 0.0F;
        }
    }

    /// Writes the depths where the pyramid may enter the children to `near`.
    HWY_INLINE Mask8 operator()(const WideNode& node, const Float8& bound, Float8& near) const {
        const Float8 back = load8(node.planes[lower_[2]]) - origin_[2];
        const Float8 front = load8(node.planes[lower_[2] + 1]) - origin_[2];
        const Float8 begin = (is_forward_ ? back : front) * sign_;
        const Float8 end = (is_forward_ ? front : back) * sign_;
        near = maximum(begin + slack_, set8(0.0F));
        Mask8 met = both(at_most(slack_, end), at_most(near, bound));
        for (std::size_t k = 0; k < 2; ++k) {
            // The box's corner that lies farthest inside each side, and how far it does.
            const Float8 low = load8(node.planes[lower_[k]]) - origin_[k];
            const Float8 high = load8(node.planes[lower_[k] + 1]) - origin_[k];
            const Float8 above =
                subtract_product(least_[k], least_is_positive_[k] ? begin : end, high);
            const Float8 below_most =
                subtract_product(most_[k], most_is_positive_[k] ? end : begin, low);
            met = both(met, both(at_most(slack_, above), at_most(slack_, set8(0.0F) - below_most)));
        }
        return met;
    }

private:
    Float8 slack_, sign_;
    Float8 origin_[3], least_[2], most_[2];
    std::uint32_t lower_[3];
    bool is_forward_;
    bool least_is_positive_[2], most_is_positive_[2];
};

/// The triangles of a leaf, with edge functions k0 + kx * slope_x + ky * slope_y.
struct LeafEdges {
    std::uint32_t possible;  // bit per triangle: a ray of the bundle may hit it
    alignas(32) float k0[3][8];
    alignas(32) float kx[3][8];
    alignas(32) float ky[3][8];
    alignas(32) float depth[3][8];  // of the corners
    alignas(32) float off[8];       // by how much an edge function may be wrong
    float margin;                   // and a depth
};

HWY_INLINE void prepare_leaf(const LeafWords& leaf,
                             const Bundle& bundle,
                             float farthest,
                             LeafEdges& edges) {
    const std::size_t count = leaf.count;
    const float slack = leaf.slack(bundle.slack);
    Float8 x[3], y[3], z[3];
    Float8 size = set8(0.0F);
    const Float8 sway = set8(bundle.spread[0] + bundle.spread[1]);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * count;
        z[i] = (load8_words(corner + bundle.axis[2] * count) - set8(bundle.origin[2])) *
               set8(bundle.sign);
        x[i] =
            subtract_product(set8(bundle.middle[0]),
                             z[i],
                             load8_words(corner + bundle.axis[0] * count) - set8(bundle.origin[0]));
        y[i] =
            subtract_product(set8(bundle.middle[1]),
                             z[i],
                             load8_words(corner + bundle.axis[1] * count) - set8(bundle.origin[1]));
        size = size + multiply_add(sway, magnitude(z[i]), magnitude(x[i]) + magnitude(y[i]));
        store8(z[i], edges.depth[i]);
    }
    const Float8 off = set8(Bundle::kEdge * slack) * (size + set8(slack));
    const Float8 minus_off = set8(0.0F) - off;
    store8(off, edges.off);
    Float8 least_most = set8(std::numeric_limits<float>::infinity());
    Float8 most_least = set8(-std::numeric_limits<float>::infinity());
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
            magnitude(kx), set8(bundle.spread[0]), magnitude(ky) * set8(bundle.spread[1]));
        least_most = minimum(least_most, k0 + range);
        most_least = maximum(most_least, k0 - range);
    }
    const Float8 shallow = minimum(minimum(z[0], z[1]), z[2]);
    const Float8 deep = maximum(maximum(z[0], z[1]), z[2]);
    edges.margin = 3.0F * slack;
    const Float8 margin = set8(edges.margin);
    const Mask8 sideways = either(at_most(minus_off, least_most), at_most(most_least, off));
    const Mask8 along =
        both(at_most(set8(0.0F) - margin, deep), at_most(shallow - margin, set8(farthest)));
    edges.possible = bits(both(sideways, along)) & ((1U << count) - 1U);
}

/// Tests one triangle against all rays. Returns whether a bound was lowered.
HWY_INLINE bool test_triangle(const LeafEdges& edges,
                              std::size_t k,
                              std::uint32_t triangle,
                              const geometry::MeshView& mesh,
                              Bundle& bundle) {
    const Float8 k0[3] = {set8(edges.k0[0][k]), set8(edges.k0[1][k]), set8(edges.k0[2][k])};
    const Float8 kx[3] = {set8(edges.kx[0][k]), set8(edges.kx[1][k]), set8(edges.kx[2][k])};
    const Float8 ky[3] = {set8(edges.ky[0][k]), set8(edges.ky[1][k]), set8(edges.ky[2][k])};
    const Float8 off = set8(edges.off[k]);
    const Float8 minus_off = set8(-edges.off[k]);
    bool is_lowered = false;
    for (std::size_t first = 0; first < bundle.count(); first += 8) {
        const Float8 slope_x = load8(bundle.slope_x + first);
        const Float8 slope_y = load8(bundle.slope_y + first);
        const Float8 u = multiply_add(ky[0], slope_y, multiply_add(kx[0], slope_x, k0[0]));
        const Float8 v = multiply_add(ky[1], slope_y, multiply_add(kx[1], slope_x, k0[1]));
        const Float8 w = multiply_add(ky[2], slope_y, multiply_add(kx[2], slope_x, k0[2]));
        const Float8 least = minimum(minimum(u, v), w);
        const Float8 most = maximum(maximum(u, v), w);
        const Mask8 maybe = either(at_most(minus_off, least), at_most(most, off));
        if (bits(maybe) == 0) {
            continue;
        }
        // As Piercing does.
        const float depths[3] = {edges.depth[0][k], edges.depth[1][k], edges.depth[2][k]};
        const float low = std::min({depths[0], depths[1], depths[2]});
        const float high = std::max({depths[0], depths[1], depths[2]});
        const Float8 shallow = set8(low);
        const Float8 deep = set8(high);
        const Float8 sum = (u + v) + w;
        const Float8 share = set8(12.0F) * off / magnitude(sum);
        const Float8 weighted =
            multiply_add(
                u, set8(depths[0]), multiply_add(v, set8(depths[1]), w * set8(depths[2]))) /
            sum;
        const Mask8 known = below(share, set8(1.0F));
        const Float8 place = minimum(maximum(weighted, shallow), deep);
        const Float8 spread = share * set8(high - low);
        const Float8 margin = set8(edges.margin);
        const Float8 from = choose(known, maximum(place - spread, shallow), shallow) - margin;
        const Float8 to = choose(known, minimum(place + spread, deep), deep) + margin;
        const Float8 bound = load8(bundle.bound + first);
        const Mask8 certain =
            both(both(known, either(below(off, least), below(most, minus_off))),
                 both(at_most(set8(0.0F), from), at_most(to, load8(bundle.inside + first))));
        const Float8 lowered = choose(certain, minimum(bound, to), bound);
        is_lowered = is_lowered || bits(below(lowered, bound)) != 0;
        store8(lowered, bundle.bound + first);
        std::uint32_t left =
            bits(both(maybe, both(at_most(from, lowered), at_most(set8(0.0F), to))));
        if (left != 0) {
            alignas(32) float near[8];
            store8(from, near);
            for (; left != 0; left &= left - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(left));
                bundle.add(mesh, first + lane, triangle, near[lane]);
            }
        }
    }
    return is_lowered;
}

HWY_INLINE float farthest_bound(const Bundle& bundle) {
    Float8 most = load8(bundle.bound);
    for (std::size_t first = 8; first < bundle.count(); first += 8) {
        most = maximum(most, load8(bundle.bound + first));
    }
    return largest(most);
}

/// Adds to every ray of the bundle what it may hit; the last of it is still to be decided. False:
/// the bundle meets more leaves than it has rays, which are then faster on their own.
HWY_INLINE bool trace_bundle(const WideTree& tree, const geometry::MeshView& mesh, Bundle& bundle) {
    const PyramidCull cull(bundle);
    const WideNode* nodes = tree.nodes().data();
    Walk walk;
    float farthest = farthest_bound(bundle);
    std::size_t leaves_left = bundle.count();
    bool goes_on = true;
    while (goes_on) {
        if (!is_leaf(walk.child)) {
            const WideNode& node = nodes[walk.child];
            Float8 near;
            const Mask8 met = cull(node, set8(farthest), near);
            walk.push(near, met, node, bundle.order_shift);
        } else {
            if (leaves_left-- == 0) {
                return false;
            }
            LeafRoom room;
            const LeafWords leaf = open_leaf(tree, walk.child, room);
            LeafEdges edges;
            prepare_leaf(leaf, bundle, farthest, edges);
            bool is_lowered = false;
            for (std::uint32_t left = edges.possible; left != 0; left &= left - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(left));
                is_lowered |= test_triangle(edges, k, leaf.triangle(k), mesh, bundle);
            }
            farthest = is_lowered ? farthest_bound(bundle) : farthest;
        }
        goes_on = walk.pop(farthest);
    }
    return true;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
