// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>

namespace earshot::frustum {

/// How the vertices of a facet's outline are seen from a frustum's apex, and the half-spaces of
/// VisibleFacets::ClipPlanes.
struct OutlineView {
    double apex[3];
    double axes[3][3];                      ///< right, up, forward
    double start_constant, start_slope[2];  ///< inverse depth of where the frustum starts
    double start_slack;                     ///< 1 where it does not start at a facet
    double min_depth;                       ///< of points that are seen without clipping, metres
    double clip_depth;                      ///< of points that clipping leaves, metres
    double lower[2], upper[2], side_error;  ///< the sides, and how far outward they are moved
};

enum class OutlineSeen {
    whole,   ///< no vertex lies before the start or closer than min_depth
    partly,  ///< to be clipped
    not_at_all,
};

/// Of an outline that is seen whole.
struct OutlineBounds {
    double lower[2], upper[2];  ///< of u and v
    double min_depth = 0.0;     ///< metres
};

/// Projects `count` vertices, at least four, each three numbers: writes u and v of each to `uv` and
/// what they span to `bounds`. Both have a meaning only if the outline is seen whole. The same bits
/// on every instruction set.
OutlineSeen view_outline(const OutlineView& view,
                         const double* vertices,
                         std::size_t count,
                         double* uv,
                         OutlineBounds& bounds) noexcept;

}  // namespace earshot::frustum
