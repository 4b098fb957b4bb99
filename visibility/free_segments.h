// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/region.h"

#include <limits>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Where a segment ends at no triangle.
inline constexpr geometry::TriangleId kNothing = std::numeric_limits<geometry::TriangleId>::max();

/// A maximal free segment: a line as far as nothing is met either way.
struct FreeSegment {
    geometry::Segment segment{};  ///< `to` lies ahead, `from` behind
    geometry::TriangleId at_from = kNothing;
    geometry::TriangleId at_to = kNothing;

    /// Whether it tells that something is seen.
    bool is_valid() const noexcept { return at_from != kNothing || at_to != kNothing; }
};

/// The free segment through the origin of every ray, along its direction both ways (Bittner et al.
/// 2009, section 3). Where nothing is met it ends at the border of the box about the region and the
/// tree; of a ray whose origin is outside of that it is empty. Precondition: the tree was built
/// over or refitted to this mesh.
std::vector<FreeSegment> cast_both_ways(const bvh::WideTree& tree,
                                        const geometry::MeshView& mesh,
                                        std::span<const geometry::Ray> rays,
                                        const Region& region,
                                        Executor& executor = Executor::serial());

/// A segment without so many metres at either end; its middle if it is no longer than both. Cells
/// may end at the very walls where segments end: with their ends drawn in by plane_slack(),
/// segments do not reach the cell behind a wall by rounding.
geometry::Segment shortened(const geometry::Segment& segment, double metres) noexcept;

}  // namespace earshot::visibility
