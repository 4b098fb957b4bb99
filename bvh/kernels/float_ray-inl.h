// SPDX-License-Identifier: MIT
//
// Setting up a FloatRay, compiled once per instruction set.

#include "earshot/base/simd/float_lanes-inl.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#if defined(EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H
#undef EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H
#else
#define EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the lanes

inline constexpr float kMinCoordinate = 0x1p-30F;  // of scenes, metres
inline constexpr float kMaxCoordinate = 0x1p30F;   // of scenes and origins
inline constexpr float kMinDirection = 0x1p-30F;   // largest components of directions
inline constexpr float kMaxDirection = 0x1p30F;
inline constexpr float kMaxInverse = 0x1p40F;  // over the shortest inverse

/// Over the larger of the scene's and the origin's coordinates.
inline constexpr float kPlanePad = 12.0F * 0x1p-24F;
/// Rounding of a corner, and what is left of the origin when two floats are taken from it.
inline constexpr float kCornerError = 1.05F * 0x1p-24F;

// set_ray() reads origin and direction as four consecutive doubles each, which is one load.
static_assert(std::is_standard_layout_v<geometry::Ray> &&
              std::is_trivially_copyable_v<geometry::Ray> &&
              sizeof(geometry::Vec3) == 3 * sizeof(double) &&
              offsetof(geometry::Ray, origin) == 0 &&
              offsetof(geometry::Ray, direction) == 3 * sizeof(double) &&
              offsetof(geometry::Ray, t_max) == 6 * sizeof(double));

/// By octant of direction, a bit per axis along which it is negative.
inline constexpr SlabPlanes kSlabPlanes[8] = {{{0, 16, 32, 0}, {8, 24, 40, 0}},
                                              {{8, 16, 32, 0}, {0, 24, 40, 0}},
                                              {{0, 24, 32, 0}, {8, 16, 40, 0}},
                                              {{8, 24, 32, 0}, {0, 16, 40, 0}},
                                              {{0, 16, 40, 0}, {8, 24, 32, 0}},
                                              {{8, 16, 40, 0}, {0, 24, 32, 0}},
                                              {{0, 24, 40, 0}, {8, 16, 32, 0}},
                                              {{8, 24, 40, 0}, {0, 16, 32, 0}}};

/// By the axis of the largest component.
inline constexpr std::uint32_t kRayAxes[3][3] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2}};

/// Sets a ray up but for t_max. False: the scene's largest coordinate, the origin or the direction
/// lie outside the range where the bounds of FloatRay hold (2^-30 to 2^30 metres, 2^-30 to 2^30),
/// or are not numbers. The fourth lanes are not used.
HWY_INLINE bool set_line(FloatRay& ray, Double4 origin, Double4 direction, float reach) {
    const Float4::Mask three = Float4::Mask::first(3);
    const Float4 zero = Float4(0.0F);
    const Float4 o = select(three, round_to_float(origin), zero);
    const Float4 rest = round_to_float(origin - to_double(o));
    const Float4 d = select(three, round_to_float(direction), Float4(1.0F));
    const Float4 inverse = Float4(1.0F) / d;
    const Float4 size = select(three, abs(d), zero);
    const Float4 longest = max_of_lanes(size);
    const Float4 distance = abs(o);
    const Float4::Mask in_range = (distance <= Float4(kMaxCoordinate)) &
                                  (size <= Float4(kMaxDirection)) &
                                  (Float4(kMinDirection) <= longest);
    if (bits(in_range) != 15U || !(reach >= kMinCoordinate && reach <= kMaxCoordinate)) {
        return false;
    }
    // Mostly no component is so small that its inverse is held, and nothing waits for the division
    // but what needs it.
    Float4 signed_inverse = inverse;
    Float4::Mask is_backward = d < zero;
    if ((bits(longest <= size * Float4(0.5F * kMaxInverse)) & 7U) != 7U) {
        const Float4 magnitude = abs(inverse);
        const Float4 shortest_inverse =
            min_of_lanes(select(three, magnitude, Float4(std::numeric_limits<float>::infinity())));
        const Float4 held = min(magnitude, Float4(kMaxInverse) * shortest_inverse);
        is_backward = inverse < zero;
        signed_inverse = select(is_backward, -held, held);
    }
    const Float4 pad = Float4(kPlanePad) * max(max_of_lanes(distance), Float4(reach));
    const Float4 outward = select(is_backward, -pad, pad);
    signed_inverse.store(ray.inverse);
    ((-o - outward) * signed_inverse).store(ray.offset_near);
    ((outward - o) * signed_inverse).store(ray.offset_far);
    const std::uint32_t octant = bits(is_backward);
    ray.planes = kSlabPlanes[octant];
    ray.order_shift = static_cast<int>(3 * octant);
    const auto z = static_cast<std::size_t>(std::countr_zero(bits(longest <= size)));
    std::copy_n(kRayAxes[z], 3, ray.axis);
    o.store(ray.origin);
    rest.store(ray.origin_rest);
    alignas(16) float inverses[4];
    inverse.store(inverses);
    ray.inverse_depth = inverses[z];
    (d * Float4(ray.inverse_depth)).store(ray.shear);
    ray.corner_error = kCornerError * reach;
    return true;
}

/// Sets a ray up; false as set_line(), or t_max is negative or not a number.
HWY_INLINE bool set_ray(FloatRay& ray, const geometry::Ray& source, float reach) {
    if (!(source.t_max >= 0.0)) {
        return false;
    }
    ray.t_max = geometry::round_up(source.t_max);
    ray.t_max_inside = geometry::round_down(source.t_max);
    // The fourth elements are those of the next field.
    const auto* const fields = reinterpret_cast<const double*>(&source);
    return set_line(
        ray, Double4::load_unaligned(fields), Double4::load_unaligned(fields + 3), reach);
}

/// Sets the ray along a segment up; false as set_line().
HWY_INLINE bool set_segment(FloatRay& ray, const geometry::Segment& segment, float reach) {
    ray.t_max = 1.0F;
    ray.t_max_inside = 1.0F;
    const Double4 from = load_three(glm::value_ptr(segment.from));
    return set_line(ray, from, load_three(glm::value_ptr(segment.to)) - from, reach);
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
