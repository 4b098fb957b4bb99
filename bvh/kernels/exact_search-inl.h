// SPDX-License-Identifier: MIT
//
// The search of a single ray for the closest hit where packed leaves hold the vertices exactly,
// compiled once per instruction set.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/exact_coordinates.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/bvh/kernels/exact_test-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/types.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

#if defined(EARSHOT_BVH_KERNELS_EXACT_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_EXACT_SEARCH_INL_H
#undef EARSHOT_BVH_KERNELS_EXACT_SEARCH_INL_H
#else
#define EARSHOT_BVH_KERNELS_EXACT_SEARCH_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the lanes

/// The search for the closest hit in a tree whose packed leaves hold the vertices exactly. A
/// triangle that single precision cannot exclude is decided at once: that takes no longer than
/// bounds of its distance would, and reads nothing but the leaf.
class ExactSearch {
public:
    ExactSearch(const WideTree& tree, const geometry::Ray& ray, float t_max)
        : bound(t_max),
          exact_(tree.exact_coordinates()),
          ray_(ray),
          reach_(tree.max_abs_coordinate()) {}

    HWY_INLINE void visit(const LeafTriangles& leaf, const FloatRay& ray) {
        const ShearedLanes at = shear(ray, leaf);
        const EdgeTest<> test(at);
        std::uint32_t possible = bits(Float8::Mask::first(leaf.count) & test.is_possible());
        if (possible == 0) {
            return;
        }
        const ConservativeHits hits = test.bounds(at, leaf.count);
        const Float8 zero = Float8(0.0F);
        const Float8::Mask certain =
            hits.certain & (zero <= hits.near) & (hits.far <= Float8(ray.t_max_inside));
        // The search goes on with this bound, and does not wait for the decisions; nor for the
        // bound where no triangle is hit for sure.
        const std::uint32_t sure = bits(certain);
        if (sure != 0) {
            bound = reduce_min(select(certain, min(hits.far, Float8(bound)), Float8(bound)));
        }
        const std::uint32_t in_range = bits((hits.near <= Float8(bound)) & (zero <= hits.far));
        for (; possible != 0; possible &= possible - 1) {
            // The lane does not depend on the bounds of distance, so a processor that predicts the
            // branch decides while it computes them.
            const auto lane = static_cast<std::size_t>(std::countr_zero(possible));
            if ((in_range >> lane & 1U) != 0) {
                const bool is_better = decide(leaf, lane);
                if ((sure >> lane & 1U) == 0 && is_better) {
                    bound = std::min(bound, float_beyond(t_));
                }
            }
        }
    }

    /// The best of the hits.
    void get(std::optional<geometry::Hit>& hit) const {
        if (triangle_ != kNoTriangle) {
            hit.emplace(geometry::Hit{triangle_, t_, u_, v_});
        }
    }

    float bound;

private:
    /// Decides one triangle; whether it is the best hit so far.
    HWY_INLINE bool decide(const LeafTriangles& leaf, std::size_t lane) {
        if (!is_prepared_) {
            test_ = ExactRay(ray_);
            is_prepared_ = true;
        }
        alignas(32) double corners[3][4];
        gather_corners(exact_, leaf.words, leaf.count, lane, test_.axes(), corners);
        const std::uint32_t triangle = leaf.triangles()[lane];
        double t = 0.0, u = 0.0, v = 0.0;
        if (!test_.hit(corners, reach_, t, u, v) || t > t_ || (t == t_ && triangle > triangle_)) {
            return false;
        }
        triangle_ = triangle;
        t_ = t;
        u_ = u;
        v_ = v;
        return true;
    }

    ExactCoordinates exact_;
    const geometry::Ray& ray_;
    double reach_;
    bool is_prepared_ = false;
    ExactRay test_;
    // The best hit; a hit at t_max is one.
    std::uint32_t triangle_ = kNoTriangle;
    double t_ = ray_.t_max, u_ = 0.0, v_ = 0.0;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
