// SPDX-License-Identifier: MIT
//
// What a ray meets in a node and in a leaf of a WideTree: included by kernels once per instruction
// set, after base/wide_float.h.

#include "earshot/bvh/internal/closest_search.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/bvh/internal/wide_node.h"
#include "earshot/bvh/wide_tree.h"

#include <glm/gtc/type_ptr.hpp>

#include <bit>
#include <cstring>
#include <limits>

#if defined(EARSHOT_BVH_WIDE_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_WIDE_STEPS_INL_H
#undef EARSHOT_BVH_WIDE_STEPS_INL_H
#else
#define EARSHOT_BVH_WIDE_STEPS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

// Of each node on the way down at most seven children wait, and compress_ordered() writes eight.
constexpr std::size_t kMostWaiting = (WideNode::kWidth - 1) * (kMaxDepth + 1) + WideNode::kWidth;

/// The plane across an axis that a triangle lies in.
struct LeftPlane {
    std::uint32_t planes = 0;  ///< first of the axis in WideNode::planes
    /// Its place along the axis; not a number: the triangle lies in no such plane, or its place is
    /// none in single precision.
    float at = std::numeric_limits<float>::quiet_NaN();

    LeftPlane() = default;
    HWY_INLINE LeftPlane(const geometry::MeshView& mesh, std::uint32_t triangle) {
        const geometry::Triangle& corners = mesh.triangles[triangle];
        const double* a = glm::value_ptr(mesh.positions[corners[0]]);
        const double* b = glm::value_ptr(mesh.positions[corners[1]]);
        const double* c = glm::value_ptr(mesh.positions[corners[2]]);
        for (std::uint32_t k = 0; k < 3; ++k) {
            const auto place = static_cast<float>(a[k]);
            if (a[k] == b[k] && a[k] == c[k] && static_cast<double>(place) == a[k]) {
                planes = 2 * WideNode::kWidth * k;
                at = place;
            }
        }
    }
};

/// The children of wide nodes that a ray passes.
class Passing {
public:
    explicit Passing(const FloatRay& ray)
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

/// Passing for a ray that leaves a triangle which lies in a plane across an axis: children that lie
/// in the same plane are left out, because the ray goes away from it.
class PassingFromPlane {
public:
    PassingFromPlane(const FloatRay& ray, const LeftPlane& left)
        : passing_(ray), planes_(left.planes), at_(set8(left.at)) {}

    HWY_INLINE Mask8 operator()(const WideNode& node, const Float8& bound, Float8& near) const {
        const Mask8 passed = passing_(node, bound, near);
        const float* planes = node.planes[0] + planes_;
        return but_not(
            passed,
            both(at_most(at_, load8(planes)), at_most(load8(planes + WideNode::kWidth), at_)));
    }

private:
    Passing passing_;
    std::uint32_t planes_;
    Float8 at_;
};

/// The triangles of a leaf as pierce() wants them: nine runs of `count` floats, then the indices.
struct LeafWords {
    const std::uint32_t* words;
    std::size_t count;
    // The corners are off by this share of FloatRay::slack, and so many metres.
    float share = 1.0F;
    float step = 0.0F;

    float slack(float of_ray) const { return share * of_ray + step; }
    std::uint32_t triangle(std::size_t lane) const { return words[9 * count + lane]; }
};

/// Room for a leaf that has to be unpacked.
struct LeafRoom {
    // The last run is written eight floats wide.
    std::uint32_t words[10 * kMostInWideLeaf + 8];
};

HWY_INLINE LeafWords unpack(const std::uint32_t* packed, std::size_t count, LeafRoom& room) {
    float frame[kFrameWords];
    std::memcpy(frame, packed, sizeof frame);
    std::uint16_t steps[9 * kMostInWideLeaf];
    std::memcpy(steps, packed + kFrameWords, sizeof steps);
    const Float8 step = set8(frame[3]);
    for (std::size_t run = 0; run < 9; ++run) {
        const Float8 values =
            multiply_add(load8_halves(steps + run * count), step, set8(frame[run % 3]));
        store8_words(values, room.words + run * count);
    }
    const std::uint32_t* triangles = packed + words_before_triangles(LeafForm::quantised, count);
    std::memcpy(room.words + 9 * count, triangles, count * sizeof *triangles);
    // A coordinate is off by half a step and by the roundings of product and sum, 3 x 2^-24 of
    // FloatRay's R; sheared, by twice that.
    return {room.words, count, 1.5F, frame[3]};
}

HWY_INLINE LeafWords open_leaf(const WideTree& tree, std::uint32_t child, LeafRoom& room) {
    const std::uint32_t* words = tree.leaf_words(child);
    const std::size_t count = leaf_count(child);
    return tree.leaf_form() == LeafForm::single ? LeafWords{words, count}
                                                : unpack(words, count, room);
}

/// What single precision knows about the triangles of a leaf.
struct LeafHits {
    std::uint32_t possible = 0;  // bit per triangle: may be hit
    Mask8 certain;               // hit by the whole line for sure
    Float8 near, far;            // bounds of where
};

/// Triangles and rays, a pair per lane: corners from the ray's origin, sheared along it.
struct ShearedLanes {
    Float8 x[3], y[3], z[3];
    Float8 slack;          // metres, by which corners are off
    Float8 inverse_depth;  // of FloatRay
};

/// The test of Woop, Benthin and Wald 2013 with the bounds of FloatRay, for the first `count`
/// lanes.
HWY_INLINE LeafHits pierce(const ShearedLanes& at, std::size_t count) {
    const auto& [x, y, z, slack, inverse_depth] = at;
    const Float8 u = subtract_product(y[2], x[1], x[2] * y[1]);
    const Float8 v = subtract_product(y[0], x[2], x[0] * y[2]);
    const Float8 w = subtract_product(y[1], x[0], x[1] * y[0]);
    const Float8 size =
        ((magnitude(x[0]) + magnitude(y[0])) + (magnitude(x[1]) + magnitude(y[1]))) +
        (magnitude(x[2]) + magnitude(y[2]));
    const Float8 off = set8(FloatRay::kEdge) * slack * (size + slack);
    const Float8 least = minimum(minimum(u, v), w);
    const Float8 most = maximum(maximum(u, v), w);
    const Float8 minus_off = set8(0.0F) - off;
    const Mask8 maybe = either(at_most(minus_off, least), at_most(most, off));
    LeafHits hits;
    hits.possible = bits(maybe) & ((1U << count) - 1U);
    if (hits.possible == 0) {
        return hits;
    }
    // Where the weights are known within `share`, the depth is known within that share of the
    // triangle's depth: of three weights each is off by `off` and so is thrice its sum, over a
    // sum that may be smaller by half.
    const Float8 sum = (u + v) + w;
    const Float8 share = set8(12.0F) * off / magnitude(sum);
    const Float8 shallow = minimum(minimum(z[0], z[1]), z[2]);
    const Float8 deep = maximum(maximum(z[0], z[1]), z[2]);
    const Float8 weighted = multiply_add(u, z[0], multiply_add(v, z[1], w * z[2])) / sum;
    const Mask8 known = below(share, set8(1.0F));
    const Float8 middle = minimum(maximum(weighted, shallow), deep);
    const Float8 spread = share * (deep - shallow);
    const Float8 margin = set8(3.0F) * slack;
    const Float8 from = choose(known, maximum(middle - spread, shallow), shallow) - margin;
    const Float8 to = choose(known, minimum(middle + spread, deep), deep) + margin;
    const Float8 t_from = from * inverse_depth;
    const Float8 t_to = to * inverse_depth;
    hits.near = minimum(t_from, t_to);
    hits.far = maximum(t_from, t_to);
    hits.certain =
        both(first_lanes(count), both(known, either(below(off, least), below(most, minus_off))));
    return hits;
}

/// A ray and the triangles of a leaf.
HWY_INLINE LeafHits pierce(const FloatRay& ray, const LeafWords& leaf) {
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
    return pierce(at, count);
}

/// Where a search for the closest hit stands.
struct Walk {
    std::size_t count = 0;
    std::uint32_t child = 0;  // to be visited next
    alignas(32) float near_of[kMostWaiting];
    std::uint32_t waiting[kMostWaiting];

    /// Lets the masked children of a node wait, the nearest on top.
    HWY_INLINE void push(const Float8& near, const Mask8& mask, const WideNode& node, int shift) {
        count += compress_ordered(
            near, mask, node.child, node.order, shift, near_of + count, waiting + count);
    }

    /// Takes the next child that waits and is near enough; false if there is none.
    HWY_INLINE bool pop(float bound) {
        do {
            if (count == 0) {
                return false;
            }
            --count;
        } while (near_of[count] > bound);
        child = waiting[count];
        return true;
    }
};

/// The triangle that a ray leaves which leaves none.
inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

/// Adds what a leaf may hold to a search, but for the triangle that the ray leaves.
HWY_INLINE void visit_leaf(const LeafWords& leaf,
                           const FloatRay& ray,
                           ClosestSearch& search,
                           std::uint32_t left_triangle = kNoTriangle) {
    const LeafHits hits = pierce(ray, leaf);
    if (hits.possible == 0) {
        return;
    }
    const Float8 zero = set8(0.0F);
    const Mask8 certain = both(
        hits.certain, both(at_most(zero, hits.near), at_most(hits.far, set8(ray.t_max_inside))));
    const float bound = smallest(choose(certain, hits.far, set8(search.bound)));
    search.bound = bound < search.bound ? bound : search.bound;
    const Mask8 in_reach = both(at_most(hits.near, set8(search.bound)), at_most(zero, hits.far));
    std::uint32_t left = bits(in_reach) & hits.possible;
    if (left != 0) {
        alignas(32) float near[8];
        store8(hits.near, near);
        for (; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            if (leaf.triangle(lane) != left_triangle) {
                search.add(leaf.triangle(lane), near[lane]);
            }
        }
    }
}

/// Goes on to the nearest child of a node; false if none is passed and none waits.
template <typename Passes>
HWY_INLINE bool descend(
    const WideNode& node, const Passes& passing, int order_shift, float bound, Walk& walk) {
    Float8 near;
    const Mask8 passed = passing(node, set8(bound), near);
    walk.push(near, passed, node, order_shift);
    return walk.pop(bound);
}

/// The same for a ray that goes alone: where one child is passed, it is taken without a detour.
template <typename Passes>
HWY_INLINE bool descend_alone(
    const WideNode& node, const Passes& passing, int order_shift, float bound, Walk& walk) {
    Float8 near;
    const Mask8 passed = passing(node, set8(bound), near);
    const std::uint32_t lanes = bits(passed);
    if (std::has_single_bit(lanes)) {
        walk.child = node.child[std::countr_zero(lanes)];
        return true;
    }
    if (lanes != 0) {
        walk.push(near, passed, node, order_shift);
    }
    return walk.pop(bound);
}

/// Whether a leaf holds a triangle that touches the segment, but for the one that it leaves.
HWY_INLINE bool touches_leaf(const LeafWords& leaf,
                             const FloatRay& ray,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             std::uint32_t left_triangle = kNoTriangle) {
    const LeafHits hits = pierce(ray, leaf);
    if (hits.possible == 0) {
        return false;
    }
    const Float8 zero = set8(0.0F);
    const Float8 one = set8(1.0F);
    const Mask8 inside = both(below(zero, hits.near), below(hits.far, one));
    if (bits(both(hits.certain, inside)) != 0) {
        return true;
    }
    const Mask8 in_reach = both(at_most(hits.near, one), at_most(zero, hits.far));
    for (std::uint32_t left = bits(in_reach) & hits.possible; left != 0; left &= left - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(left));
        const geometry::Triangle& triangle = mesh.triangles[leaf.triangle(lane)];
        if (leaf.triangle(lane) != left_triangle &&
            geometry::touches(segment,
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
