// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/internal/border_segments.h"
#include "earshot/geometry/internal/box_tree.h"
#include "earshot/geometry/types.h"

#include <vector>

namespace earshot::geometry {

/// Outline edges on one straight line that touch or overlap each other.
struct BorderLine {
    Vec3 origin{0.0};     ///< the smaller end (by x, then y, then z) of the longest edge
    Vec3 direction{0.0};  ///< unit vector towards its other end
    std::vector<BorderEdge> edges;

    /// Metres along the line from its origin.
    double z_of(const Vec3& point) const noexcept;
    Vec3 point_at(double z) const noexcept { return origin + z * direction; }
    /// From the first end of an edge to the last, grown by `margin`, metres.
    Box box(double margin) const noexcept;
};

/// Adds the lines of edges that are connected by contacts (border_segments.h). Chains of such pairs
/// may bend slowly: what is off the line of the longest edge by more than `tolerance`, metres,
/// becomes a line of its own. Of each line the edges stay in their order.
void split_into_lines(std::vector<BorderEdge> edges,
                      double tolerance,
                      std::vector<BorderLine>& lines);

}  // namespace earshot::geometry
