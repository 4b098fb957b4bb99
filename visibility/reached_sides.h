// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/triangle_sides.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

struct ReachedSidesOptions {
    std::uint64_t seed = 1;
    std::uint64_t rays_per_point = 200'000;  ///< limit of the guided sampling of each point
    std::uint64_t rays_per_side = 16;        ///< of a side that has just been reached
    std::uint64_t rays_back_per_side = 64;   ///< of a side that nothing has reached, at last
    std::uint64_t max_rays = 20'000'000;     ///< from sides, in all
    double tolerance = 0.0;  ///< metres: triangles nearer to each other cover a part of each other
    Progress* progress = nullptr;  ///< receives "air"
};

/// What can be reached from points along polylines that bend at surfaces, as sampled: each reached
/// side is proved by a ray, others may have been missed.
struct ReachedSides {
    static constexpr std::uint32_t kNone = 0xffffffffU;

    /// Per side: the number of its air, or kNone. Points and sides are of one air if rays link
    /// them. Numbers are in the order of the airs' first points.
    std::vector<std::uint32_t> air_of_side;
    std::vector<std::uint32_t> air_of_point;  ///< per point
    std::uint32_t airs = 0;
    /// Per reached side: a ray from a point, or from another reached side, whose closest hit it is.
    /// Else a ray without length (t_max = 0).
    std::vector<geometry::Ray> witnesses;
    std::uint64_t rays = 0;
    /// Per point, of random directions: the share of first hits that are backs, and the share of
    /// rays that hit nothing.
    std::vector<double> back_share, escape_share;
};

/// Guided visibility sampling from every point (sample_region); then every side that was reached
/// sends rays itself, until no new one is met. From sides that nothing has reached rays are sent to
/// the reached ones: the way back, if free, is a witness. Of triangles that meet others, a part of
/// which may be covered, only the places that rays hit count as reached. The same for any executor.
/// Precondition: every triangle has an area.
ReachedSides sample_reached_sides(const bvh::MeshBvh& bvh,
                                  std::span<const geometry::Vec3> points,
                                  const ReachedSidesOptions& options = {},
                                  Executor& executor = Executor::serial());

}  // namespace earshot::visibility
