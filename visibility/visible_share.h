// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace earshot::visibility {

/// A ball; what a point sees of it is the part of its surface that faces the point.
struct SphereTarget {
    geometry::Vec3 centre{0.0};
    double radius = 0.0;  ///< metres, > 0
};

/// corner, corner + side_u, corner + side_u + side_v, corner + side_v.
struct ParallelogramTarget {
    geometry::Vec3 corner{0.0}, side_u{0.0}, side_v{0.0};
};

/// How much of a target a point sees.
struct VisibleShare {
    /// 0 ... 1: of the solid angle that a ball takes up, of the area of a parallelogram.
    double share = 0.0;
    /// The true share lies within this; 0 where occluders and empty space alone decide. Where rays
    /// take part it is the part that they are cast in, or, if less, a bound that one in a million
    /// shares exceeds.
    double error = 0.0;
    std::uint64_t rays = 0;  ///< that were cast
    friend bool operator==(const VisibleShare&, const VisibleShare&) = default;
};

struct VisibleShareOptions {
    /// The most rays for one share, 8 ... 2^20. The error where they decide everything is 2.7 over
    /// its root.
    std::size_t max_rays = 2048;
    std::uint64_t seed = 1;
};

/// Shares of targets that points see, as the lines of sight to all of their points would tell
/// (line_of_sight.h). The target is divided into cells, again and again: a cell is wholly visible
/// if no triangle touches the hull of the point and the cell, and wholly hidden if a single
/// triangle, or the convex polygon of coplanar ones, provably covers it; both err to the side of
/// more division. Cells at the end of the division are decided by one ray each to a random point of
/// theirs (Lauterbach 2010, section 6.3, casts rays only where the outline of an occluder may be).
/// Answers depend on the mesh, the mask and the options alone. Const members may be called from
/// many threads.
class VisibleShareQuery {
public:
    /// Takes time like clean-up and facets. The hierarchy's mesh must outlive it.
    VisibleShareQuery(const bvh::MeshBvh& bvh,
                      const ExclusionMask& excluded = {},
                      Executor& executor = Executor::serial());
    ~VisibleShareQuery();
    VisibleShareQuery(VisibleShareQuery&&) noexcept;
    VisibleShareQuery& operator=(VisibleShareQuery&&) noexcept;

    /// A point in the ball or on it sees all of it. Preconditions: coordinates are finite, at most
    /// 1e12 m; the radius is positive; max_rays is in range.
    VisibleShare share(const geometry::Vec3& from,
                       const SphereTarget& target,
                       const VisibleShareOptions& options = {}) const;
    /// Preconditions: likewise; the sides are not parallel.
    VisibleShare share(const geometry::Vec3& from,
                       const ParallelogramTarget& target,
                       const VisibleShareOptions& options = {}) const;

    /// Every `from` point to a ball of `radius` about every `to` point: a row per `from` point.
    std::vector<VisibleShare> matrix(std::span<const geometry::Vec3> from,
                                     std::span<const geometry::Vec3> to,
                                     double radius,
                                     const VisibleShareOptions& options = {},
                                     Executor& executor = Executor::serial()) const;

private:
    struct State;
    std::unique_ptr<const State> state_;
};

}  // namespace earshot::visibility
