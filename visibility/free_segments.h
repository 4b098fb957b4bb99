// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/exclusion_mask.h"
#include "earshot/visibility/region.h"

#include <limits>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Stands for "no triangle": a ray that hits nothing, or the end of a segment in free space.
inline constexpr geometry::TriangleId kNoTriangle =
    std::numeric_limits<geometry::TriangleId>::max();

/// A maximal free line segment: a line extended both ways up to the first triangle.
struct FreeSegment {
    geometry::Segment segment{};  ///< `to` lies ahead, `from` behind
    geometry::TriangleId at_from = kNoTriangle;
    geometry::TriangleId at_to = kNoTriangle;

    /// Whether a triangle is visible at one end at least: a valid sample of visibility.
    bool is_valid() const noexcept { return at_from != kNoTriangle || at_to != kNoTriangle; }
};

/// The maximal free segment through the origin of every ray, by a ray along its direction and one
/// against it (Bittner et al. 2009, section 3). A segment that hits nothing ends at the boundary of
/// the box around the region and the tree; that of a ray whose origin is outside of this box is
/// empty. Excluded triangles are
/// treated as absent.
std::vector<FreeSegment> cast_free_segments(const bvh::MeshBvh& bvh,
                                            std::span<const geometry::Ray> rays,
                                            const ViewRegion& region,
                                            const ExclusionMask& excluded = {},
                                            Executor& executor = Executor::serial());

/// A segment without so many metres at either end; its midpoint if it is no longer than both. Cells
/// may end at the very walls where segments end: segments shortened by plane_slack() do not reach
/// the cell behind a wall by rounding.
geometry::Segment shortened(const geometry::Segment& segment, double metres) noexcept;

}  // namespace earshot::visibility
