// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

// Point-to-point visibility. The line of sight between two points is the closed segment, ends
// included, and a triangle blocks it if the two share a point: an edge that is grazed blocks, so
// does a corner, and so does a triangle whose plane the segment runs in and which it meets there; a
// line of sight that ends on a triangle is blocked by it. This is decided exactly
// (geometry::touches), so answers do not depend on the order of the two points, on the tree or on
// the executor; and a mesh whose triangles share their edges has no gaps. The winding of a triangle
// plays no part.
//
// Precondition: coordinates are finite, at most 1e12 m. May be called from many threads.

/// The triangle that blocks a line of sight.
struct Blocker {
    geometry::TriangleId triangle = 0;
    double t = 0.0;  ///< where the segment first touches it: 0 at `from`, 1 at `to`, within 2^-37
    friend bool operator==(const Blocker&, const Blocker&) = default;
};

/// Whether no triangle outside of the exclusion mask blocks the segment. Does not allocate.
bool visible(const bvh::MeshBvh& bvh,
             const geometry::Segment& segment,
             const ExclusionMask& excluded = {}) noexcept;

/// The triangle that blocks the segment first from `from`: the one of the smallest `t`, and of
/// several at one `t`, as at a shared edge, the one of the lowest TriangleId. Empty if visible().
/// Does not allocate.
std::optional<Blocker> first_blocker(const bvh::MeshBvh& bvh,
                                     const geometry::Segment& segment,
                                     const ExclusionMask& excluded = {}) noexcept;

// Batches of segments. In a tree too large for the caches they are traversed in an order in which
// neighbours take similar paths through it; the results stand in the order of the segments.

/// visible() of every segment: 1 or 0.
std::vector<std::uint8_t> visible(const bvh::MeshBvh& bvh,
                                  std::span<const geometry::Segment> segments,
                                  const ExclusionMask& excluded = {},
                                  Executor& executor = Executor::serial());

/// first_blocker() of every segment.
std::vector<std::optional<Blocker>> first_blockers(const bvh::MeshBvh& bvh,
                                                   std::span<const geometry::Segment> segments,
                                                   const ExclusionMask& excluded = {},
                                                   Executor& executor = Executor::serial());

}  // namespace earshot::visibility
