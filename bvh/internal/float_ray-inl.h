// SPDX-License-Identifier: MIT
//
// Setting up a FloatRay: included by kernels once per instruction set, after base/wide_float.h.

#include "earshot/bvh/internal/float_ray.h"
#include "earshot/geometry/aabb.h"

#include <algorithm>
#include <cmath>

#if defined(EARSHOT_BVH_FLOAT_RAY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_FLOAT_RAY_INL_H
#undef EARSHOT_BVH_FLOAT_RAY_INL_H
#else
#define EARSHOT_BVH_FLOAT_RAY_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

inline constexpr double kSmallest = 0x1p-40;  // coordinates, metres
inline constexpr double kLargest = 0x1p40;
inline constexpr double kShortest = 0x1p-30;  // directions
inline constexpr double kLongest = 0x1p30;
inline constexpr double kMostInverse = 0x1p40;  // over the shortest inverse

inline constexpr double kPlanePad = 0x1p-22;
inline constexpr double kInverseSlack = 0x1p-22;
inline constexpr double kCornerSlack = 0x1p-20;
inline constexpr double kEdge = 2.5;

/// The larger of two numbers; not a number if the second is none.
HWY_INLINE double larger(double a, double b) {
    return a > b ? a : b;
}

/// Sets a ray up. False: coordinates or direction lie outside the range where the bounds of
/// FloatRay hold (2^-40 to 2^40 metres, 2^-30 to 2^30), or are not numbers.
HWY_INLINE bool set_ray(FloatRay& ray,
                        const geometry::Vec3& from,
                        const geometry::Vec3& direction,
                        double most,
                        double reach) {
    alignas(32) const double o[4] = {from.x, from.y, from.z, 0.0};
    alignas(32) const double d[4] = {direction.x, direction.y, direction.z, 1.0};
    const double size = larger(larger(std::abs(d[0]), std::abs(d[1])), std::abs(d[2]));
    const double scene =
        larger(larger(std::abs(o[0]), std::abs(o[1])), larger(std::abs(o[2]), reach));
    const double sum = ((o[0] + o[1]) + o[2]) + ((d[0] + d[1]) + d[2]);
    if (!(scene >= kSmallest && scene <= kLargest && size >= kShortest && size <= kLongest &&
          sum - sum == 0.0 && most >= 0.0)) {
        return false;
    }
    const double most_inverse = kMostInverse / size;
    const double pad = kPlanePad * scene;
    alignas(32) double inverses[4];
    for (std::size_t k = 0; k < 4; ++k) {
        inverses[k] = 1.0 / d[k];
        const double inverse =
            std::copysign(std::min(std::abs(inverses[k]), most_inverse), inverses[k]);
        const double outward = std::copysign(pad, inverse);
        ray.inverse_near[k] = static_cast<float>(inverse * (1.0 - kInverseSlack));
        ray.inverse_far[k] = static_cast<float>(inverse * (1.0 + kInverseSlack));
        ray.offset_near[k] =
            static_cast<float>(-(o[k] + outward) * static_cast<double>(ray.inverse_near[k]));
        ray.offset_far[k] =
            static_cast<float>(-(o[k] - outward) * static_cast<double>(ray.inverse_far[k]));
    }
    ray.order_shift = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t backward = std::signbit(d[k]) ? 1 : 0;
        ray.near_plane[k] = 2 * k + backward;
        ray.far_plane[k] = 2 * k + 1 - backward;
        ray.order_shift += static_cast<int>(3 * backward) << k;
    }
    const std::uint32_t z = std::abs(d[0]) == size ? 0 : std::abs(d[1]) == size ? 1 : 2;
    const std::uint32_t x = z == 2 ? 0 : z + 1;
    const std::uint32_t y = x == 2 ? 0 : x + 1;
    ray.axis[0] = x;
    ray.axis[1] = y;
    ray.axis[2] = z;
    for (std::size_t k = 0; k < 3; ++k) {
        ray.origin[k] = static_cast<float>(o[ray.axis[k]]);
    }
    ray.shear_x = static_cast<float>(d[x] * inverses[z]);
    ray.shear_y = static_cast<float>(d[y] * inverses[z]);
    ray.inverse_depth = static_cast<float>(inverses[z]);
    ray.slack = static_cast<float>(kCornerSlack * scene);
    ray.edge_slack = static_cast<float>(kEdge * kCornerSlack * scene);
    ray.t_max = geometry::round_up(most);
    ray.t_max_inside = geometry::round_down(most);
    return true;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
