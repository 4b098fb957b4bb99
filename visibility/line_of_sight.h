// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/ignored.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

// Whether two points see each other. The line between them is the closed segment, ends included,
// and a triangle blocks it if the two share a point: an edge that is grazed blocks, so does a
// corner, and so does a triangle whose plane the segment runs in and which it meets there; a point
// that lies on a triangle sees nothing through it, not even itself. This is decided exactly
// (geometry::touches), so answers do not depend on which end is asked first, on the tree or on the
// executor; and a mesh whose triangles share their edges has no gaps. Which side a triangle turns
// plays no part.
//
// Preconditions: the tree was built over or refitted to this mesh, and coordinates are finite, at
// most 1e12 m. Const trees may be asked from many threads.

/// What stands in a line of sight.
struct Blocker {
    geometry::TriangleId triangle = 0;
    double t = 0.0;  ///< where the segment first touches it: 0 at `from`, 1 at `to`, within 2^-37
    friend bool operator==(const Blocker&, const Blocker&) = default;
};

/// Whether nothing blocks the segment but what is ignored. Does not allocate.
bool sees(const bvh::WideTree& tree,
          const geometry::MeshView& mesh,
          const geometry::Segment& segment,
          const Ignored& ignored = {}) noexcept;

/// What blocks the segment first, seen from `from`: the triangle of the smallest `t`, and of
/// several at one `t`, as at a shared edge, the one of the lowest TriangleId. Empty if sees().
/// Does not allocate.
std::optional<Blocker> first_blocker(const bvh::WideTree& tree,
                                     const geometry::MeshView& mesh,
                                     const geometry::Segment& segment,
                                     const Ignored& ignored = {}) noexcept;

// The same for many segments. Of a tree too large for the caches they are asked in an order in
// which neighbours take similar ways through it; the results stand in the order of the segments.

/// sees() of every segment: 1 or 0.
std::vector<std::uint8_t> sees(const bvh::WideTree& tree,
                               const geometry::MeshView& mesh,
                               std::span<const geometry::Segment> segments,
                               const Ignored& ignored = {},
                               Executor& executor = Executor::serial());

/// first_blocker() of every segment.
std::vector<std::optional<Blocker>> first_blockers(const bvh::WideTree& tree,
                                                   const geometry::MeshView& mesh,
                                                   std::span<const geometry::Segment> segments,
                                                   const Ignored& ignored = {},
                                                   Executor& executor = Executor::serial());

}  // namespace earshot::visibility
