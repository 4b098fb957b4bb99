// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/region.h"

#include <cstdint>
#include <vector>

namespace earshot::visibility {

struct GuidedOptions {
    std::uint64_t seed = 1;
    std::uint64_t most_rays = 10'000'000;
    /// The work ends when the last `window` rays found fewer than `fewest_new` triangles.
    std::uint64_t window = 1'000'000;
    std::uint64_t fewest_new = 50;
    bool guided = true;   ///< false: random rays only, to compare with
    bool reverse = true;  ///< look past what blocks a triangle's border
    /// How far outside of a triangle's border rays go, radians.
    double border_angle = 1e-6;
    /// Hits nearer to each other than this share of the scene's diagonal are taken for one surface.
    double threshold = 1e-3;
    Progress* progress = nullptr;  ///< told of "rays"
    Interrupt interrupt{};         ///< asked between batches; the result is then what was found
};

/// What a region sees, as far as rays tell: a subset of all (an aggressive set), each member of
/// which is proved by a ray.
struct RegionView {
    std::vector<geometry::TriangleId> triangles;  ///< ascending
    /// One per triangle: from the region, and the triangle is the nearest that it meets. Of those
    /// that reach into the region itself, and were met by no ray, the ray has no length
    /// (t_max = 0) and starts in the region.
    std::vector<geometry::Ray> witnesses;
    std::uint64_t rays = 0;
    /// Of the random rays, which leave every place of the region's border in all directions alike,
    /// in the last half of the work: the share that met a triangle which none had met.
    double missed_share = 0.0;
    struct Point {
        std::uint64_t rays, triangles;
    };
    std::vector<Point> curve;  ///< how the set grew, after every batch
};

/// Which triangles can be seen from somewhere in a region (Wonka et al. 2006, guided visibility
/// sampling): random rays from its border, and from each triangle that is found rays by its own
/// border, between these where they fall apart, and past what blocks them. A region may be flat or
/// a point. Triangles that reach into it are seen. The set depends on mesh, region and options
/// alone, unless it is interrupted. Throws Error as check(region).
/// Precondition: the tree was built over or refitted to this mesh.
RegionView sample_region(const bvh::WideTree& tree,
                         const geometry::MeshView& mesh,
                         const Region& region,
                         const GuidedOptions& options = {},
                         Executor& executor = Executor::serial());

}  // namespace earshot::visibility
