// SPDX-License-Identifier: MIT
//
// Conservative tests of a ray against the nodes and leaves of a WideTree: included by kernels once
// per instruction set, after base/wide_float.h.

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/bvh/internal/wide_node.h"
#include "earshot/bvh/wide_tree.h"

#include <glm/gtc/type_ptr.hpp>

#include <bit>
#include <cstring>
#include <limits>

#if defined(EARSHOT_BVH_KERNELS_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_LEAF_INL_H
#undef EARSHOT_BVH_KERNELS_LEAF_INL_H
#else
#define EARSHOT_BVH_KERNELS_LEAF_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

// Every node on the path down leaves at most seven children on the stack, and compress_ordered()
// writes eight.
constexpr std::size_t kMaxStackSize = (WideNode::kWidth - 1) * (kMaxDepth + 1) + WideNode::kWidth;

/// The axis-aligned plane that an excluded triangle lies in.
struct ExcludedPlane {
    std::uint32_t planes = 0;  ///< first of the axis in WideNode::planes
    /// Its coordinate along the axis; not a number: the triangle lies in no such plane, or the
    /// coordinate is no float.
    float at = std::numeric_limits<float>::quiet_NaN();

    ExcludedPlane() = default;
    HWY_INLINE ExcludedPlane(const geometry::MeshView& mesh, std::uint32_t triangle) {
        const geometry::Triangle& corners = mesh.triangles[triangle];
        const double* a = glm::value_ptr(mesh.positions[corners[0]]);
        const double* b = glm::value_ptr(mesh.positions[corners[1]]);
        const double* c = glm::value_ptr(mesh.positions[corners[2]]);
        for (std::uint32_t k = 0; k < 3; ++k) {
            const auto coordinate = static_cast<float>(a[k]);
            if (a[k] == b[k] && a[k] == c[k] && static_cast<double>(coordinate) == a[k]) {
                planes = 2 * WideNode::kWidth * k;
                at = coordinate;
            }
        }
    }
};

/// The slab test (Kay and Kajiya 1986) of a ray against the eight children of a wide node.
class SlabTest {
public:
    explicit SlabTest(const FloatRay& ray)
        : ray_(ray),
          inverse_near_{
              set8(ray.inverse_near[0]), set8(ray.inverse_near[1]), set8(ray.inverse_near[2])},
          offset_near_{
              set8(ray.offset_near[0]), set8(ray.offset_near[1]), set8(ray.offset_near[2])},
          inverse_far_{
              set8(ray.inverse_far[0]), set8(ray.inverse_far[1]), set8(ray.inverse_far[2])},
          offset_far_{set8(ray.offset_far[0]), set8(ray.offset_far[1]), set8(ray.offset_far[2])} {}

    /// Writes the distances where the ray enters the children to `near`.
    HWY_INLINE Mask8 operator()(const WideNode& node, const Float8& bound, Float8& near) const {
        const float* planes = node.planes[0];
        const Float8 near_x =
            multiply_add(load8(planes + ray_.near_plane[0]), inverse_near_[0], offset_near_[0]);
        const Float8 near_y =
            multiply_add(load8(planes + ray_.near_plane[1]), inverse_near_[1], offset_near_[1]);
        const Float8 near_z =
            multiply_add(load8(planes + ray_.near_plane[2]), inverse_near_[2], offset_near_[2]);
        const Float8 far_x =
            multiply_add(load8(planes + ray_.far_plane[0]), inverse_far_[0], offset_far_[0]);
        const Float8 far_y =
            multiply_add(load8(planes + ray_.far_plane[1]), inverse_far_[1], offset_far_[1]);
        const Float8 far_z =
            multiply_add(load8(planes + ray_.far_plane[2]), inverse_far_[2], offset_far_[2]);
        near = maximum(maximum(near_x, near_y), maximum(near_z, set8(0.0F)));
        const Float8 far = minimum(minimum(far_x, far_y), minimum(far_z, bound));
        return at_most(near, far);
    }

private:
    const FloatRay& ray_;
    Float8 inverse_near_[3], offset_near_[3], inverse_far_[3], offset_far_[3];
};

/// The slab test of a secondary ray whose excluded (origin) triangle lies in an axis-aligned plane:
/// children that are coplanar with it are skipped, because the ray goes away from that plane.
class SlabTestSkippingCoplanar {
public:
    SlabTestSkippingCoplanar(const FloatRay& ray, const ExcludedPlane& excluded)
        : slab_test_(ray), planes_(excluded.planes), at_(set8(excluded.at)) {}

    HWY_INLINE Mask8 operator()(const WideNode& node, const Float8& bound, Float8& near) const {
        const Mask8 passed = slab_test_(node, bound, near);
        const float* planes = node.planes[0] + planes_;
        return but_not(
            passed,
            both(at_most(at_, load8(planes)), at_most(load8(planes + WideNode::kWidth), at_)));
    }

private:
    SlabTest slab_test_;
    std::uint32_t planes_;
    Float8 at_;
};

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
    const Float8 step = set8(frame[3]);
    for (std::size_t run = 0; run < 9; ++run) {
        const Float8 values =
            multiply_add(load8_halves(steps + run * count), step, set8(frame[run % 3]));
        store8_words(values, buffer.words + run * count);
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
    Mask8 certain;               // hit by the whole line for sure
    Float8 near, far;            // bounds of t
};

/// Triangles and rays, a pair per lane: corners from the ray's origin, sheared along it.
struct ShearedLanes {
    Float8 x[3], y[3], z[3];
    Float8 slack;          // metres, by which corners are error
    Float8 inverse_depth;  // of FloatRay
};

/// The test of Woop, Benthin and Wald 2013 with the bounds of FloatRay, for the first `count`
/// lanes.
HWY_INLINE ConservativeHits intersect(const ShearedLanes& at, std::size_t count) {
    const auto& [x, y, z, slack, inverse_depth] = at;
    const Float8 u = subtract_product(y[2], x[1], x[2] * y[1]);
    const Float8 v = subtract_product(y[0], x[2], x[0] * y[2]);
    const Float8 w = subtract_product(y[1], x[0], x[1] * y[0]);
    const Float8 size =
        ((magnitude(x[0]) + magnitude(y[0])) + (magnitude(x[1]) + magnitude(y[1]))) +
        (magnitude(x[2]) + magnitude(y[2]));
    const Float8 error = set8(FloatRay::kEdgeError) * slack * (size + slack);
    const Float8 lowest = minimum(minimum(u, v), w);
    const Float8 highest = maximum(maximum(u, v), w);
    const Float8 minus_error = set8(0.0F) - error;
    const Mask8 maybe = either(at_most(minus_error, lowest), at_most(highest, error));
    ConservativeHits hits;
    hits.possible = bits(maybe) & ((1U << count) - 1U);
    if (hits.possible == 0) {
        return hits;
    }
    // Where the weights are known within `relative_error`, the depth is known within that share of
    // the triangle's depth: of three weights each is off by `error` and so is thrice its sum, over
    // a sum that may be smaller by half.
    const Float8 sum = (u + v) + w;
    const Float8 relative_error = set8(12.0F) * error / magnitude(sum);
    const Float8 min_depth = minimum(minimum(z[0], z[1]), z[2]);
    const Float8 max_depth = maximum(maximum(z[0], z[1]), z[2]);
    const Float8 weighted = multiply_add(u, z[0], multiply_add(v, z[1], w * z[2])) / sum;
    const Mask8 known = below(relative_error, set8(1.0F));
    const Float8 middle = minimum(maximum(weighted, min_depth), max_depth);
    const Float8 spread = relative_error * (max_depth - min_depth);
    const Float8 depth_error = set8(3.0F) * slack;
    const Float8 from = choose(known, maximum(middle - spread, min_depth), min_depth) - depth_error;
    const Float8 to = choose(known, minimum(middle + spread, max_depth), max_depth) + depth_error;
    const Float8 t_from = from * inverse_depth;
    const Float8 t_to = to * inverse_depth;
    hits.near = minimum(t_from, t_to);
    hits.far = maximum(t_from, t_to);
    hits.certain = both(first_lanes(count),
                        both(known, either(below(error, lowest), below(highest, minus_error))));
    return hits;
}

/// A ray and the triangles of a leaf.
HWY_INLINE ConservativeHits intersect(const FloatRay& ray, const LeafTriangles& leaf) {
    const std::size_t count = leaf.count;
    ShearedLanes at;
    at.slack = set8(leaf.slack(ray.slack));
    at.inverse_depth = set8(ray.inverse_depth);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t* corner = leaf.words + 3 * i * count;
        at.z[i] = load8_words(corner + ray.axis[2] * count) - set8(ray.origin[2]);
        at.x[i] = subtract_product(set8(ray.shear_x),
                                   at.z[i],
                                   load8_words(corner + ray.axis[0] * count) - set8(ray.origin[0]));
        at.y[i] = subtract_product(set8(ray.shear_y),
                                   at.z[i],
                                   load8_words(corner + ray.axis[1] * count) - set8(ray.origin[1]));
    }
    return intersect(at, count);
}

/// The traversal stack of one ray or packet: the children still to be visited and where they begin.
struct TraversalStack {
    std::size_t count = 0;
    std::uint32_t current = 0;  // to be visited next
    alignas(32) float entry_near[kMaxStackSize];
    std::uint32_t entry[kMaxStackSize];

    /// Pushes the masked children of a node, the closest on top.
    HWY_INLINE void push(const Float8& near, const Mask8& mask, const WideNode& node, int shift) {
        count += compress_ordered(
            near, mask, node.child, node.order, shift, entry_near + count, entry + count);
    }

    /// Pops the next child that begins before `bound` into `current`; false if there is none.
    HWY_INLINE bool pop(float bound) {
        do {
            if (count == 0) {
                return false;
            }
            --count;
        } while (entry_near[count] > bound);
        current = entry[count];
        return true;
    }
};

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
    const Float8 zero = set8(0.0F);
    const Mask8 certain = both(
        hits.certain, both(at_most(zero, hits.near), at_most(hits.far, set8(ray.t_max_inside))));
    const float bound = smallest(choose(certain, hits.far, set8(search.bound)));
    search.bound = bound < search.bound ? bound : search.bound;
    const Mask8 in_range = both(at_most(hits.near, set8(search.bound)), at_most(zero, hits.far));
    std::uint32_t remaining = bits(in_range) & hits.possible;
    if (remaining != 0) {
        alignas(32) float near[8];
        store8(hits.near, near);
        for (; remaining != 0; remaining &= remaining - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(remaining));
            if (leaf.triangle(lane) != excluded) {
                search.add(leaf.triangle(lane), near[lane]);
            }
        }
    }
}

/// Continues with the closest child of a node; false if the ray misses all and the stack is empty.
template <typename Passes>
HWY_INLINE bool descend(const WideNode& node,
                        const Passes& slab_test,
                        int order_shift,
                        float bound,
                        TraversalStack& stack) {
    Float8 near;
    const Mask8 passed = slab_test(node, set8(bound), near);
    stack.push(near, passed, node, order_shift);
    return stack.pop(bound);
}

/// The same in the single-ray kernel: where the ray passes one child only, the stack is bypassed.
template <typename Passes>
HWY_INLINE bool descend_single_ray(const WideNode& node,
                                   const Passes& slab_test,
                                   int order_shift,
                                   float bound,
                                   TraversalStack& stack) {
    Float8 near;
    const Mask8 passed = slab_test(node, set8(bound), near);
    const std::uint32_t lanes = bits(passed);
    if (std::has_single_bit(lanes)) {
        stack.current = node.child[std::countr_zero(lanes)];
        return true;
    }
    if (lanes != 0) {
        stack.push(near, passed, node, order_shift);
    }
    return stack.pop(bound);
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
    const Float8 zero = set8(0.0F);
    const Float8 one = set8(1.0F);
    const Mask8 inside = both(below(zero, hits.near), below(hits.far, one));
    if (bits(both(hits.certain, inside)) != 0) {
        return true;
    }
    const Mask8 in_range = both(at_most(hits.near, one), at_most(zero, hits.far));
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
