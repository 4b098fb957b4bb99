// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"

#include <cstdint>
#include <vector>

namespace earshot::visibility {

/// How densely visible_triangles() samples the sphere of directions.
struct VisibleTrianglesOptions {
    static constexpr double kMinResolution = 1e-4;  ///< the finest, radians
    static constexpr double kMaxResolution = 0.2;   ///< the coarsest, radians

    /// Angle between neighbouring rays of the item buffer where they are farthest apart, radians;
    /// the item buffer takes about 24 / resolution^2 rays. Precondition: kMinResolution ...
    /// kMaxResolution.
    double resolution = math::kPi / 360.0;
    /// Refine the set: sample adaptively between the pixels of the item buffer.
    bool refine = true;
    /// An interval between two directions in which different triangles are visible is subdivided
    /// down to this angle, radians. Precondition: positive.
    double min_gap = 1e-5;
    /// The enlarged polygon of adaptive border sampling lies this angle outside of a triangle,
    /// radians. Precondition: positive.
    double border_angle = 1e-6;
    /// Limit of the rays that the refinement casts.
    std::uint64_t max_refining_rays = std::uint64_t{1} << 32U;
    ExclusionMask excluded{};  ///< triangles that are treated as absent
};

/// A triangle with the direction that proves it visible.
struct VisibleTriangle {
    geometry::TriangleId triangle = 0;
    /// Unit vector: in this direction it is the closest hit.
    geometry::Vec3 direction{};
    std::uint64_t pixels = 0;  ///< pixels of the item buffer that show it; 0: found by refinement
    double solid_angle = 0.0;  ///< of these pixels together, steradians
    friend bool operator==(const VisibleTriangle&, const VisibleTriangle&) = default;
};

/// The triangles visible from a point, and the work of finding them.
struct VisibleTriangles {
    std::vector<VisibleTriangle> triangles;  ///< by ascending TriangleId
    double free_solid_angle = 0.0;           ///< of the pixels that show no triangle, steradians
    std::uint64_t rays = 0;                  ///< all rays that were cast
    bool is_complete = true;                 ///< false: `max_refining_rays` were not enough
    friend bool operator==(const VisibleTriangles&, const VisibleTriangles&) = default;
};

}  // namespace earshot::visibility
