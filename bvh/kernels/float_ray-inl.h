// SPDX-License-Identifier: MIT
//
// Setting up a FloatRay, compiled once per instruction set.

#include "earshot/bvh/internal/float_ray.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/sheared_ray.h"

#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H
#undef EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H
#else
#define EARSHOT_BVH_KERNELS_FLOAT_RAY_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

inline constexpr float kMinCoordinate = 0x1p-40F;  // coordinates, metres
inline constexpr float kMaxCoordinate = 0x1p40F;
inline constexpr float kMinDirection = 0x1p-30F;  // directions
inline constexpr float kMaxDirection = 0x1p30F;
inline constexpr float kMaxInverse = 0x1p40F;  // over the shortest inverse

inline constexpr float kPlanePad = 0x1p-21F;
inline constexpr float kInverseSlack = 0x1p-21F;
inline constexpr float kCornerSlack = 0x1p-20F;

/// By value, which is one instruction; through the references of std::max() the set-up is slower.
HWY_INLINE float max(float a, float b) {
    return a > b ? a : b;
}

// set_ray() reads origin and direction as four consecutive doubles each, which is one load.
static_assert(std::is_standard_layout_v<geometry::Ray> &&
              std::is_trivially_copyable_v<geometry::Ray> &&
              sizeof(geometry::Vec3) == 3 * sizeof(double) &&
              offsetof(geometry::Ray, origin) == 0 &&
              offsetof(geometry::Ray, direction) == 3 * sizeof(double) &&
              offsetof(geometry::Ray, t_max) == 6 * sizeof(double));

/// Sets a ray up. False: coordinates or direction lie outside the range where the bounds of
/// FloatRay hold (2^-40 to 2^40 metres, 2^-30 to 2^30), or are not numbers.
HWY_INLINE bool set_ray(FloatRay& ray, const geometry::Ray& source, float reach) {
    // The fourth elements are the next field's, and not used.
    const auto* const bytes = reinterpret_cast<const std::byte*>(&source);
    double from[4];
    double direction[4];
    std::memcpy(from, bytes + offsetof(geometry::Ray, origin), sizeof from);
    std::memcpy(direction, bytes + offsetof(geometry::Ray, direction), sizeof direction);
    alignas(16) float o[4];
    alignas(16) float d[4];
    alignas(16) float inverses[4];
    alignas(16) float sizes[4];
    for (std::size_t k = 0; k < 4; ++k) {
        o[k] = static_cast<float>(from[k]);
        d[k] = static_cast<float>(direction[k]);
        inverses[k] = 1.0F / d[k];
        sizes[k] = std::abs(d[k]);
    }
    const float size = max(max(sizes[0], sizes[1]), sizes[2]);
    const float scene = max(max(std::abs(o[0]), std::abs(o[1])), max(std::abs(o[2]), reach));
    const float sum = ((o[0] + o[1]) + o[2]) + ((d[0] + d[1]) + d[2]);
    if (!(scene >= kMinCoordinate && scene <= kMaxCoordinate && size >= kMinDirection &&
          size <= kMaxDirection && sum - sum == 0.0F && source.t_max >= 0.0)) {
        return false;
    }
    const float max_inverse = kMaxInverse / size;
    const float pad = kPlanePad * scene;
    for (std::size_t k = 0; k < 4; ++k) {
        const float magnitude = std::abs(inverses[k]);
        const float held = magnitude < max_inverse ? magnitude : max_inverse;
        const float inverse = std::copysign(held, d[k]);
        const float outward = std::copysign(pad, d[k]);
        ray.inverse_near[k] = inverse * (1.0F - kInverseSlack);
        ray.inverse_far[k] = inverse * (1.0F + kInverseSlack);
        ray.offset_near[k] = -(o[k] + outward) * ray.inverse_near[k];
        ray.offset_far[k] = -(o[k] - outward) * ray.inverse_far[k];
    }
    ray.order_shift = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t backward = std::bit_cast<std::uint32_t>(d[k]) >> 31;
        ray.near_plane[k] = 8 * (2 * k + backward);
        ray.far_plane[k] = 8 * (2 * k + 1 - backward);
        ray.order_shift += static_cast<int>(3 * backward) << k;
    }
    const auto [x, y, z] = geometry::RayAxes::of(sizes[0], sizes[1], size);
    ray.axis[0] = static_cast<std::uint32_t>(x);
    ray.axis[1] = static_cast<std::uint32_t>(y);
    ray.axis[2] = static_cast<std::uint32_t>(z);
    for (std::size_t k = 0; k < 3; ++k) {
        ray.origin[k] = o[ray.axis[k]];
    }
    ray.shear_x = d[x] * inverses[z];
    ray.shear_y = d[y] * inverses[z];
    ray.inverse_depth = inverses[z];
    ray.slack = kCornerSlack * scene;
    ray.t_max = geometry::round_up(source.t_max);
    ray.t_max_inside = geometry::round_down(source.t_max);
    return true;
}

HWY_INLINE geometry::Ray ray_along(const geometry::Segment& segment) {
    return {segment.from, segment.to - segment.from, 1.0};
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
