// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>

namespace earshot::frustum {

/// A frustum's half-spaces, to which facets are clipped: beyond where it starts, at its least
/// depth, and four sides. All are moved outward by the position error of the points.
struct OutlineView {
    double apex[3];
    double axes[3][3];                      ///< right, up, forward
    double start_constant, start_slope[2];  ///< inverse depth of where the frustum starts
    double start_offset;                    ///< -1; 0: it does not start at a facet
    double start_slack_per_error;           ///< per metre
    double min_depth;                       ///< metres
    double lower[2], upper[2];              ///< the sides
};

inline constexpr std::size_t kHalfSpaces = 6;
inline constexpr std::uint32_t kAllHalfSpaces = (1U << kHalfSpaces) - 1;
inline constexpr std::uint32_t kDepthHalfSpaces = 3;  ///< bits of the first two

enum class OutlineSeen {
    whole,   ///< beyond the start, and so deep that errors hardly move directions
    partly,  ///< to be clipped
    not_at_all,
};

/// What of an outline is seen.
struct OutlineBounds {
    // Seen whole:
    double lower[2], upper[2];  ///< of u and v
    double min_depth = 0.0;     ///< metres
    // Seen partly:
    std::uint32_t crossed = 0;  ///< bit k: vertices may lie outside half-space k
};

/// Projects `count` vertices, at least four, each three numbers: writes u and v of each to `uv` and
/// what they span to `bounds`, if the outline is seen whole. `position_error`: of the vertices,
/// metres. `error_factor`: of u times depth, per metre of it. The same bits on every instruction
/// set.
OutlineSeen view_outline(const OutlineView& view,
                         double position_error,
                         double error_factor,
                         const double* vertices,
                         std::size_t count,
                         double* uv,
                         OutlineBounds& bounds) noexcept;

}  // namespace earshot::frustum
