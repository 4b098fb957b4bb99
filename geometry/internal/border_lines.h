// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"
#include "earshot/geometry/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// An edge of a facet's outline; the facet lies to its left seen against the normal.
struct BorderEdge {
    Vec3 from{0.0}, to{0.0};
    FacetId facet = 0;
};

/// Outline edges on one straight line that touch or overlap each other.
struct BorderLine {
    Vec3 origin{0.0};     ///< the smaller end (by x, then y, then z) of the longest edge
    Vec3 direction{0.0};  ///< unit vector towards its other end
    std::vector<BorderEdge> edges;
};

/// The outline edges of the facets, grouped by line. `tolerance`: metres that an end of an edge may
/// lie from the line. Facets with `excluded` 1 (or none if it is empty) take no part. Lines are
/// ordered by their lowest facet, edges by facet and along its loops.
std::vector<BorderLine> find_border_lines(const Facets& facets,
                                          std::span<const std::uint8_t> excluded,
                                          double tolerance);

}  // namespace earshot::geometry
