// SPDX-License-Identifier: MIT
//
// Decoding the leaves of a WideTree and conservative tests of a ray against their triangles,
// compiled once per instruction set.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/bvh/internal/wide_node.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(EARSHOT_BVH_KERNELS_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_LEAF_INL_H
#undef EARSHOT_BVH_KERNELS_LEAF_INL_H
#else
#define EARSHOT_BVH_KERNELS_LEAF_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the lanes

/// The decoded triangles of a leaf: nine runs of `count` floats, then the indices.
struct LeafTriangles {
    const std::uint32_t* words;
    std::size_t count;
    // The corners are off by this share of FloatRay::slack, and so many metres.
    float relative_error = 1.0F;
    float step = 0.0F;

    float slack(float of_ray) const { return relative_error * of_ray + step; }
    std::uint32_t triangle(std::size_t lane) const { return words[9 * count + lane]; }
};

/// Holds a leaf that has to be dequantised.
struct DecodeBuffer {
    // The last run is written eight floats wide.
    std::uint32_t words[10 * kMaxLeafTriangles + 8];
};

HWY_INLINE LeafTriangles dequantise(const std::uint32_t* packed,
                                    std::size_t count,
                                    DecodeBuffer& buffer) {
    float frame[kQuantisationFrameWords];
    std::memcpy(frame, packed, sizeof frame);
    std::uint16_t steps[9 * kMaxLeafTriangles];
    std::memcpy(steps, packed + kQuantisationFrameWords, sizeof steps);
    const Float8 step = Float8(frame[3]);
    for (std::size_t run = 0; run < 9; ++run) {
        const Float8 values =
            mul_add(load_uint16(steps + run * count), step, Float8(frame[run % 3]));
        store_bits(values, buffer.words + run * count);
    }
    const std::uint32_t* triangles = packed + triangle_ids_offset(LeafEncoding::quantised, count);
    std::memcpy(buffer.words + 9 * count, triangles, count * sizeof *triangles);
    // A coordinate is off by half a step and by the roundings of product and sum, 3 x 2^-24 of
    // FloatRay's R; sheared, by twice that.
    return {buffer.words, count, 1.5F, frame[3]};
}

HWY_INLINE LeafTriangles decode_leaf(const WideTree& tree,
                                     std::uint32_t child,
                                     DecodeBuffer& buffer) {
    const std::uint32_t* words = tree.packed_leaf(child);
    const std::size_t count = leaf_count(child);
    return tree.leaf_encoding() == LeafEncoding::single ? LeafTriangles{words, count}
                                                        : dequantise(words, count, buffer);
}

/// What single precision proves about the triangles of a leaf.
struct ConservativeHits {
    std::uint32_t possible = 0;  // bit per triangle: may be hit
    Float8::Mask certain;        // hit by the whole line for sure
    Float8 near, far;            // bounds of t
};

/// Triangles and rays, a pair per lane: corners from the ray's origin, sheared along it.
struct ShearedLanes {
    Float8 x[3], y[3], z[3];
    Float8 slack;          // metres, by which corners may be off
    Float8 inverse_depth;  // of FloatRay
};

/// The test of Woop, Benthin and Wald 2013 with the bounds of FloatRay, for the first `count`
/// lanes.
HWY_INLINE ConservativeHits intersect(const ShearedLanes& at, std::size_t count) {
    const auto& [x, y, z, slack, inverse_depth] = at;
    // Edge functions; a triangle is possible unless two have opposite signs for sure.
    const Float8 u = neg_mul_add(y[2], x[1], x[2] * y[1]);
    const Float8 v = neg_mul_add(y[0], x[2], x[0] * y[2]);
    const Float8 w = neg_mul_add(y[1], x[0], x[1] * y[0]);
    const Float8 size =
        ((abs(x[0]) + abs(y[0])) + (abs(x[1]) + abs(y[1]))) + (abs(x[2]) + abs(y[2]));
    const Float8 error = Float8(FloatRay::kEdgeError) * slack * (size + slack);
    const Float8 lowest = min(min(u, v), w);
    const Float8 highest = max(max(u, v), w);
    const Float8 minus_error = Float8(0.0F) - error;
    const Float8::Mask maybe = (minus_error <= lowest) | (highest <= error);
    ConservativeHits hits;
    hits.possible = bits(maybe) & ((1U << count) - 1U);
    if (hits.possible == 0) {
        return hits;
    }
    // Where the weights are known within `relative_error`, the depth is known within that share of
    // the triangle's depth: of three weights each is off by `error` and so is thrice its sum, over
    // a sum that may be smaller by half.
    const Float8 sum = (u + v) + w;
    const Float8 relative_error = Float8(12.0F) * error / abs(sum);
    const Float8 min_depth = min(min(z[0], z[1]), z[2]);
    const Float8 max_depth = max(max(z[0], z[1]), z[2]);
    const Float8 weighted = mul_add(u, z[0], mul_add(v, z[1], w * z[2])) / sum;
    const Float8::Mask known = relative_error < Float8(1.0F);
    const Float8 middle = min(max(weighted, min_depth), max_depth);
    const Float8 spread = relative_error * (max_depth - min_depth);
    const Float8 depth_error = Float8(3.0F) * slack;
    const Float8 from = select(known, max(middle - spread, min_depth), min_depth) - depth_error;
    const Float8 to = select(known, min(middle + spread, max_depth), max_depth) + depth_error;
    const Float8 t_from = from * inverse_depth;
    const Float8 t_to = to * inverse_depth;
    hits.near = min(t_from, t_to);
    hits.far = max(t_from, t_to);
    // The whole line hits for sure where all edge functions have one sign for sure.
    hits.certain =
        Float8::Mask::first(count) & known & ((error < lowest) | (highest < minus_error));
    return hits;
}

/// A ray and the triangles of a leaf.
HWY_INLINE ConservativeHits intersect(const FloatRay& ray, const LeafTriangles& leaf) {
    const std::size_t count = leaf.count;
    ShearedLanes at;
    at.slack = Float8(leaf.slack(ray.slack));
    at.inverse_depth = Float8(ray.inverse_depth);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * count;
        at.z[i] = load_bits(corner + ray.axis[2] * count) - Float8(ray.origin[2]);
        at.x[i] = neg_mul_add(Float8(ray.shear_x),
                              at.z[i],
                              load_bits(corner + ray.axis[0] * count) - Float8(ray.origin[0]));
        at.y[i] = neg_mul_add(Float8(ray.shear_y),
                              at.z[i],
                              load_bits(corner + ray.axis[1] * count) - Float8(ray.origin[1]));
    }
    return intersect(at, count);
}

/// Excludes no triangle.
inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

/// Adds the triangles of a leaf that may be the closest hit to a search, but for the excluded one.
HWY_INLINE void visit_leaf(const LeafTriangles& leaf,
                           const FloatRay& ray,
                           ClosestHitSearch& search,
                           std::uint32_t excluded = kNoTriangle) {
    const ConservativeHits hits = intersect(ray, leaf);
    if (hits.possible == 0) {
        return;
    }
    const Float8 zero = Float8(0.0F);
    const Float8::Mask certain =
        hits.certain & (zero <= hits.near) & (hits.far <= Float8(ray.t_max_inside));
    const float bound = reduce_min(select(certain, hits.far, Float8(search.bound)));
    search.bound = bound < search.bound ? bound : search.bound;
    const Float8::Mask in_range = (hits.near <= Float8(search.bound)) & (zero <= hits.far);
    std::uint32_t remaining = bits(in_range) & hits.possible;
    if (remaining != 0) {
        alignas(32) float near[8];
        hits.near.store(near);
        for (; remaining != 0; remaining &= remaining - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
            if (leaf.triangle(lane) != excluded) {
                search.add(leaf.triangle(lane), near[lane]);
            }
        }
    }
}

/// Whether a leaf holds a triangle that touches the segment, but for the excluded one.
HWY_INLINE bool touches_leaf(const LeafTriangles& leaf,
                             const FloatRay& ray,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             std::uint32_t excluded = kNoTriangle) {
    const ConservativeHits hits = intersect(ray, leaf);
    if (hits.possible == 0) {
        return false;
    }
    const Float8 zero = Float8(0.0F);
    const Float8 one = Float8(1.0F);
    const Float8::Mask inside = (zero < hits.near) & (hits.far < one);
    if (bits(hits.certain & inside) != 0) {
        return true;
    }
    const Float8::Mask in_range = (hits.near <= one) & (zero <= hits.far);
    std::uint32_t remaining = bits(in_range) & hits.possible;
    for (; remaining != 0; remaining &= remaining - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
        const geometry::Triangle& triangle = mesh.triangles[leaf.triangle(lane)];
        if (leaf.triangle(lane) != excluded && geometry::touches(segment,
                                                                 mesh.positions[triangle[0]],
                                                                 mesh.positions[triangle[1]],
                                                                 mesh.positions[triangle[2]])) {
            return true;
        }
    }
    return false;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
