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
    // The corners are off by this multiple of FloatRay::corner_error, and so many metres.
    float error_factor = 1.0F;
    float step_error = 0.0F;

    float corner_error(float of_ray) const { return error_factor * of_ray + step_error; }
    float sheared_error(float of_packet) const { return 1.5F * of_packet + 2.0F * step_error; }
    const std::uint32_t* triangles() const { return words + 9 * count; }
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
    // FloatRay's R.
    return {buffer.words, count, 3.0F, 0.51F * frame[3]};
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
    Float8::Mask possible;  // may be hit
    Float8::Mask certain;   // hit by the whole line for sure
    Float8 near, far;       // bounds of t
};

/// Triangles and rays, a pair per lane: corners from the ray's origin, sheared along it.
struct ShearedLanes {
    Float8 x[3], y[3], z[3];
    Float8 corner_error;   // metres by which a coordinate of a corner is off
    Float8 inverse_depth;  // of FloatRay
};

/// The terms of the bounds; docs/algorithms/bvh-rays.md proves them.
struct ProvenTerms {
    static constexpr float kRoundoff = 0x1p-24F;
    static constexpr float kDepth = 10.0F * kRoundoff;     ///< of a sheared corner, per depth
    static constexpr float kLateral = 4.0F * kRoundoff;    ///< and per |x| + |y|
    static constexpr float kEdge = 1.5F;                   ///< of an edge function, per |x| + |y|
    static constexpr float kMaxKnown = 1.0F / 11.0F;       ///< weights are known below this share
    static constexpr float kSpread = 5.0F;                 ///< of depths, per share
    static constexpr float kDistance = 20.0F * kRoundoff;  ///< of a distance, per depth
};

/// The test of Woop, Benthin and Wald 2013 with proven bounds, whose proof is in
/// docs/algorithms/bvh-rays.md.
template <typename Terms = ProvenTerms>
struct EdgeTest {
    Float8 u, v, w;  // edge functions
    Float8 error;    // by which each may be off
    Float8 lowest, highest;
    Float8 max_depth;  // the largest |z| of a corner

    explicit HWY_INLINE EdgeTest(const ShearedLanes& at) {
        const auto& [x, y, z, corner_error, inverse_depth] = at;
        u = neg_mul_add(y[2], x[1], x[2] * y[1]);
        v = neg_mul_add(y[0], x[2], x[0] * y[2]);
        w = neg_mul_add(y[1], x[0], x[1] * y[0]);
        const Float8 size =
            ((abs(x[0]) + abs(y[0])) + (abs(x[1]) + abs(y[1]))) + (abs(x[2]) + abs(y[2]));
        max_depth = max(max(abs(z[0]), abs(z[1])), abs(z[2]));
        const Float8 sheared_error =
            mul_add(max_depth,
                    Float8(Terms::kDepth),
                    mul_add(size, Float8(Terms::kLateral), corner_error + corner_error));
        error = Float8(Terms::kEdge) * sheared_error * size;
        lowest = min(min(u, v), w);
        highest = max(max(u, v), w);
    }

    /// False: two edge functions have opposite signs for sure.
    HWY_INLINE Float8::Mask is_possible() const { return (-error <= lowest) | (highest <= error); }

    HWY_INLINE ConservativeHits bounds(const ShearedLanes& at, std::size_t count) const {
        const auto& [x, y, z, corner_error, inverse_depth] = at;
        const Float8 inverse_sum = Float8(1.0F) / ((u + v) + w);
        const Float8 relative_error = error * abs(inverse_sum);
        const Float8::Mask known = relative_error < Float8(Terms::kMaxKnown);
        const Float8 shallowest = min(min(z[0], z[1]), z[2]);
        const Float8 deepest = max(max(z[0], z[1]), z[2]);
        const Float8 weighted = mul_add(u, z[0], mul_add(v, z[1], w * z[2])) * inverse_sum;
        const Float8 spread = Float8(Terms::kSpread) * relative_error * (deepest - shallowest);
        const Float8 margin = mul_add(max_depth, Float8(Terms::kDistance), corner_error);
        const Float8 from = select(known, max(weighted - spread, shallowest), shallowest) - margin;
        const Float8 to = select(known, min(weighted + spread, deepest), deepest) + margin;
        const Float8 t_from = from * inverse_depth;
        const Float8 t_to = to * inverse_depth;
        const Float8::Mask within = Float8::Mask::first(count);
        return {.possible = within & is_possible(),
                .certain = within & known & ((error < lowest) | (highest < -error)),
                .near = min(t_from, t_to),
                .far = max(t_from, t_to)};
    }
};

/// A ray and the triangles of a leaf. Lanes from the leaf's count on hold other numbers.
HWY_INLINE ShearedLanes shear(const FloatRay& ray, const LeafTriangles& leaf) {
    ShearedLanes at;
    at.corner_error = Float8(leaf.corner_error(ray.corner_error));
    at.inverse_depth = Float8(ray.inverse_depth);
    const auto from_origin = [&](const std::uint32_t* corner, std::uint32_t axis) {
        return (load_bits(corner + axis * leaf.count) - Float8(ray.origin[axis])) -
               Float8(ray.origin_rest[axis]);
    };
    const auto [x, y, z] = ray.axis;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * leaf.count;
        at.z[i] = from_origin(corner, z);
        at.x[i] = neg_mul_add(Float8(ray.shear[x]), at.z[i], from_origin(corner, x));
        at.y[i] = neg_mul_add(Float8(ray.shear[y]), at.z[i], from_origin(corner, y));
    }
    return at;
}

/// Excludes no triangle.
inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

/// Whether the test of a leaf ends early where no triangle is possible. Without that branch, which
/// is often mispredicted, the tests of interleaved rays are faster.
enum class EarlyExit { yes, no };

/// Adds the triangles of a leaf that may be the closest hit to a search, but for the excluded one.
template <EarlyExit kEarlyExit = EarlyExit::yes>
HWY_INLINE void visit_leaf(const LeafTriangles& leaf,
                           const FloatRay& ray,
                           ClosestHitSearch& search,
                           std::uint32_t excluded = kNoTriangle) {
    const ShearedLanes at = shear(ray, leaf);
    const EdgeTest<> test(at);
    if (kEarlyExit == EarlyExit::yes &&
        !any(Float8::Mask::first(leaf.count) & test.is_possible())) {
        return;
    }
    const ConservativeHits hits = test.bounds(at, leaf.count);
    const Float8 zero = Float8(0.0F);
    const Float8::Mask stays = differs(leaf.triangles(), excluded);
    const Float8::Mask certain =
        hits.certain & stays & (zero <= hits.near) & (hits.far <= Float8(ray.t_max_inside));
    const Float8 bound = Float8(search.bound);
    search.bound = reduce_min(select(certain, min(hits.far, bound), bound));
    const Float8::Mask is_candidate =
        hits.possible & (hits.near <= Float8(search.bound)) & (zero <= hits.far) & stays;
    search.reserve();
    const std::size_t added = compress(hits.near,
                                       is_candidate,
                                       leaf.triangles(),
                                       search.candidates.near_end(),
                                       search.candidates.triangles_end());
    search.candidates.count += added;
    // A batch defers its decisions, and fetches what they need then.
    if (kEarlyExit == EarlyExit::yes) {
        search.prefetch(added);
    }
}

/// Whether a leaf holds a triangle that touches the segment, but for the excluded one.
template <EarlyExit kEarlyExit = EarlyExit::yes>
HWY_INLINE bool touches_leaf(const LeafTriangles& leaf,
                             const FloatRay& ray,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             std::uint32_t excluded = kNoTriangle) {
    const ShearedLanes at = shear(ray, leaf);
    const EdgeTest<> test(at);
    if (kEarlyExit == EarlyExit::yes &&
        !any(Float8::Mask::first(leaf.count) & test.is_possible())) {
        return false;
    }
    const ConservativeHits hits = test.bounds(at, leaf.count);
    const Float8 zero = Float8(0.0F);
    const Float8 one = Float8(1.0F);
    const Float8::Mask stays = differs(leaf.triangles(), excluded);
    const Float8::Mask inside = (zero < hits.near) & (hits.far < one);
    const bool is_blocked = any(hits.certain & inside & stays);
    const Float8::Mask in_range = (hits.near <= one) & (zero <= hits.far);
    std::uint32_t remaining = is_blocked ? 0 : bits(in_range & hits.possible & stays);
    for (; remaining != 0; remaining &= remaining - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
        const auto [a, b, c] = geometry::corners(mesh, leaf.triangles()[lane]);
        if (geometry::touches(segment, a, b, c)) {
            return true;
        }
    }
    return is_blocked;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
