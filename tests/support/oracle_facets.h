// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::support {

/// The oracle computes in extended precision: 64 bits of mantissa on x86-64.
using Real = long double;
using Point = glm::vec<3, Real, glm::defaultp>;

/// Margins are exact up to this many metres and cut off there: nobody asks how clear "clear" is.
inline constexpr Real kMarginCap = 1e-3L;

struct OraclePlane {
    Point normal{0.0L, 1.0L, 0.0L};  ///< unit length
    Real offset = 0.0L;

    Real distance(const Point& point) const { return glm::dot(normal, point) - offset; }
    Point mirror(const Point& point) const { return point - 2.0L * distance(point) * normal; }
};

/// Coplanar triangles of one label that hang together by edges.
struct OracleFacet {
    OraclePlane plane;  ///< of the largest triangle, the normal on its front
    std::uint32_t label = 0;
    std::vector<std::array<Point, 3>> triangles;
    std::vector<std::array<Point, 2>> border;  ///< edges that belong to one triangle of the facet
    Point centre{0.0L};                        ///< of a ball around the facet
    Real radius = 0.0L;
};

/// Groups triangles without any index structure: from the largest triangle not yet taken, every
/// triangle that shares an edge (two equal positions), has the same label and lies within
/// `tolerance` metres of its plane is added until none is left. O(n^2).
std::vector<OracleFacet> group_facets(const geometry::MeshView& mesh,
                                      std::span<const std::uint32_t> labels,
                                      Real tolerance);

/// How deep a point of the facet's plane lies in the facet: distance to its border, negative
/// outside.
Real depth_inside(const OracleFacet& facet, const Point& point);

/// How clear of the facet the closed segment is: their distance, or if they meet, minus the length
/// by which either would have to move before they no longer do (cut off at kMarginCap).
Real clearance(const OracleFacet& facet, const Point& from, const Point& to);

}  // namespace earshot::support
