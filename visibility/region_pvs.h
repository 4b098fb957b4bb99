// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"

#include <cstdint>
#include <vector>

namespace earshot::visibility {

/// Parameters of guided visibility sampling.
struct GuidedSamplingOptions {
    std::uint64_t seed = 1;
    std::uint64_t max_rays = 10'000'000;
    /// Sampling ends when the last `window` rays added fewer than `min_new_triangles`.
    std::uint64_t window = 1'000'000;
    std::uint64_t min_new_triangles = 50;
    bool guided = true;   ///< false: random rays only, as a baseline
    bool reverse = true;  ///< cast rays past the occluders of a triangle's border
    /// The enlarged polygon of adaptive border sampling lies this angle outside of a triangle,
    /// radians.
    double border_angle = 1e-6;
    /// Hits nearer to each other than this fraction of the scene's diagonal count as one surface.
    double threshold = 1e-3;
    ExclusionMask excluded{};      ///< triangles that are treated as absent
    Progress* progress = nullptr;  ///< receives "rays"
    Interrupt interrupt{};         ///< checked between batches; an interrupted result is partial
};

/// The potentially visible set (PVS) of a region as sampled: a subset of the true set (an
/// aggressive set), each member of which is proved by a ray.
struct RegionPvs {
    std::vector<geometry::TriangleId> triangles;  ///< ascending
    /// One per triangle: a ray from the region whose closest hit is the triangle. A triangle that
    /// reaches into the region and that no ray has hit has a ray without length (t_max = 0) that
    /// starts in the region.
    std::vector<geometry::Ray> witnesses;
    std::uint64_t rays = 0;
    struct Point {
        std::uint64_t rays, triangles;
    };
    std::vector<Point> curve;  ///< size of the set after every batch
};

}  // namespace earshot::visibility
