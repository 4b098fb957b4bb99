// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/outline_view.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/frustum/outline_view_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/word_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::frustum::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

HWY_INLINE FourPoints local_points(const OutlineView& view, const double* vertices) {
    FourPoints p = load_points(vertices);
    p.x = p.x - Double4(view.apex[0]);
    p.y = p.y - Double4(view.apex[1]);
    p.z = p.z - Double4(view.apex[2]);
    const auto along = [&](const double* axis) {
        return p.x * Double4(axis[0]) + p.y * Double4(axis[1]) + p.z * Double4(axis[2]);
    };
    return {along(view.axes[0]), along(view.axes[1]), along(view.axes[2])};
}

HWY_INLINE Double4 distance_behind_start(const OutlineView& view, const FourPoints& p) {
    return Double4(view.start_constant) * p.z + Double4(view.start_slope[0]) * p.x +
           Double4(view.start_slope[1]) * p.y - Double4(1.0) + Double4(view.start_slack);
}

/// Bit k: one of four points is in half-space k.
HWY_INLINE std::uint32_t half_spaces_met(const OutlineView& view, const FourPoints& p) {
    const Double4 zero(0.0), error(view.side_error);
    const auto met = [&](const Double4& distance, int k) {
        return static_cast<std::uint32_t>(any(zero <= distance)) << k;
    };
    return met(distance_behind_start(view, p), 0) | met(p.z - Double4(view.clip_depth), 1) |
           met(p.x - Double4(view.lower[0]) * p.z + error, 2) |
           met(Double4(view.upper[0]) * p.z - p.x + error, 3) |
           met(p.y - Double4(view.lower[1]) * p.z + error, 4) |
           met(Double4(view.upper[1]) * p.z - p.y + error, 5);
}

/// Four vertices at a time, the last four again where their number is no multiple of four.
template <typename Visit>
HWY_INLINE void for_each_four(std::size_t count, Visit&& visit) {
    for (std::size_t i = 0; i < count; i += 4) {
        visit(std::min(i, count - 4));
    }
}

OutlineSeen seen_from_apex(const OutlineView& view,
                           const double* vertices,
                           std::size_t count,
                           double* uv,
                           OutlineBounds& bounds) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr std::uint32_t kAll = 0x3f;
    constexpr std::uint32_t kFour = 0xf;
    Double4 lower_u(kInfinity), lower_v(kInfinity), min_depth(kInfinity);
    Double4 upper_u(-kInfinity), upper_v(-kInfinity);
    bool is_whole = true;
    std::uint32_t met = 0;
    for_each_four(count, [&](std::size_t i) {
        const FourPoints p = local_points(view, vertices + 3 * i);
        is_whole = is_whole && bits((Double4(view.min_depth) <= p.z) &
                                    (Double4(0.0) <= distance_behind_start(view, p))) == kFour;
        if (!is_whole) {
            met |= half_spaces_met(view, p);
            return;
        }
        met = kAll;  // nearly so: whether vertices lie beside the sides is left to clipping
        const Double4 inverse = Double4(1.0) / p.z;
        const Double4 u = p.x * inverse, v = p.y * inverse;
        store_pairs(u, v, uv + 2 * i);
        lower_u = min(lower_u, u);
        upper_u = max(upper_u, u);
        lower_v = min(lower_v, v);
        upper_v = max(upper_v, v);
        min_depth = min(min_depth, p.z);
    });
    if (!is_whole) {
        return met == kAll ? OutlineSeen::partly : OutlineSeen::not_at_all;
    }
    bounds = {.lower = {reduce_min(lower_u), reduce_min(lower_v)},
              .upper = {reduce_max(upper_u), reduce_max(upper_v)},
              .min_depth = reduce_min(min_depth)};
    return OutlineSeen::whole;
}

}  // namespace earshot::frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::frustum {

HWY_EXPORT(seen_from_apex);

OutlineSeen view_outline(const OutlineView& view,
                         const double* vertices,
                         std::size_t count,
                         double* uv,
                         OutlineBounds& bounds) noexcept {
    return HWY_DYNAMIC_DISPATCH(seen_from_apex)(view, vertices, count, uv, bounds);
}

}  // namespace earshot::frustum
#endif
