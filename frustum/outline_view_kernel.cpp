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

/// The half-spaces with the errors of the points.
struct HalfSpaceDistances {
    HalfSpaceDistances(const OutlineView& the_view, double position_error, double error_factor)
        : view(the_view),
          start_slack(the_view.start_slack_per_error * position_error),
          clip_depth(the_view.min_depth - position_error),
          side_error(error_factor * position_error) {}

    HWY_INLINE Double4 behind_start(const FourPoints& p) const {
        return Double4(view.start_constant) * p.z + Double4(view.start_slope[0]) * p.x +
               Double4(view.start_slope[1]) * p.y + Double4(view.start_offset) +
               Double4(start_slack);
    }

    /// Calls visit(distance, k) for each; points inside have a distance that is not negative.
    template <typename Visit>
    HWY_INLINE void for_each(const FourPoints& p, Visit&& visit) const {
        const Double4 error(side_error);
        visit(behind_start(p), 0);
        visit(p.z - Double4(clip_depth), 1);
        visit(p.x - Double4(view.lower[0]) * p.z + error, 2);
        visit(Double4(view.upper[0]) * p.z - p.x + error, 3);
        visit(p.y - Double4(view.lower[1]) * p.z + error, 4);
        visit(Double4(view.upper[1]) * p.z - p.y + error, 5);
    }

    const OutlineView& view;
    double start_slack, clip_depth, side_error;
};

OutlineSeen seen_from_apex(const OutlineView& view,
                           double position_error,
                           double error_factor,
                           const double* vertices,
                           std::size_t count,
                           double* uv,
                           OutlineBounds& bounds) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr std::uint32_t kFour = 0xf;
    const HalfSpaceDistances half_spaces(view, position_error, error_factor);
    const Double4 zero(0.0);
    const Double4 min_z(std::max(view.min_depth, 2.0 * half_spaces.side_error));
    Double4 lower_u(kInfinity), lower_v(kInfinity), min_depth(kInfinity);
    Double4 upper_u(-kInfinity), upper_v(-kInfinity);
    bool is_whole = true;
    std::uint32_t met = 0, crossed = 0;
    // Four vertices at a time, the last four again where their number is no multiple of four.
    for (std::size_t next = 0; next < count; next += 4) {
        const std::size_t i = std::min(next, count - 4);
        const FourPoints p = local_points(view, vertices + 3 * i);
        is_whole =
            is_whole && bits((min_z <= p.z) & (zero <= half_spaces.behind_start(p))) == kFour;
        if (!is_whole) {
            half_spaces.for_each(p, [&](const Double4& distance, int k) {
                const std::uint32_t inside = bits(zero <= distance);
                met |= static_cast<std::uint32_t>(inside != 0) << k;
                crossed |= static_cast<std::uint32_t>(inside != kFour) << k;
            });
            continue;
        }
        met = crossed =
            kAllHalfSpaces;  // where vertices before one that is not seen lie is left to clipping
        const Double4 inverse = Double4(1.0) / p.z;
        const Double4 u = p.x * inverse, v = p.y * inverse;
        store_pairs(u, v, uv + 2 * i);
        lower_u = min(lower_u, u);
        upper_u = max(upper_u, u);
        lower_v = min(lower_v, v);
        upper_v = max(upper_v, v);
        min_depth = min(min_depth, p.z);
    }
    if (!is_whole) {
        bounds.crossed = crossed;
        return met == kAllHalfSpaces ? OutlineSeen::partly : OutlineSeen::not_at_all;
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
                         double position_error,
                         double error_factor,
                         const double* vertices,
                         std::size_t count,
                         double* uv,
                         OutlineBounds& bounds) noexcept {
    return HWY_DYNAMIC_DISPATCH(seen_from_apex)(
        view, position_error, error_factor, vertices, count, uv, bounds);
}

}  // namespace earshot::frustum
#endif
