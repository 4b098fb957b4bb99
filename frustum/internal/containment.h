// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/predicates.h"
#include "earshot/geometry/types.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace earshot::frustum {

/// The two coordinates that remain when the plane's dominant axis is dropped.
inline glm::dvec2 project(const geometry::Vec3& point, int axis) noexcept {
    return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

inline double squared_distance_to_edge(const glm::dvec2& p,
                                       const glm::dvec2& a,
                                       const glm::dvec2& b) {
    const glm::dvec2 edge = b - a;
    const double squared = glm::dot(edge, edge);
    const double t = squared > 0.0 ? std::clamp(glm::dot(p - a, edge) / squared, 0.0, 1.0) : 0.0;
    const glm::dvec2 gap = p - (a + t * edge);
    return glm::dot(gap, gap);
}

inline bool lies_in_box(const glm::dvec2& p, const std::array<glm::dvec2, 3>& corner) noexcept {
    const glm::dvec2 lower = glm::min(glm::min(corner[0], corner[1]), corner[2]);
    const glm::dvec2 upper = glm::max(glm::max(corner[0], corner[1]), corner[2]);
    return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y;
}

/// Whether a point lies in a triangle, borders included: decided exactly. A sliver may stand on
/// edge in its facet and project to a line, all of whose points are on no edge's outside: its box
/// tells them apart.
inline bool is_inside(const glm::dvec2& p, const std::array<glm::dvec2, 3>& corner) {
    const int ab = geometry::orient2d(corner[0], corner[1], p);
    const int bc = geometry::orient2d(corner[1], corner[2], p);
    const int ca = geometry::orient2d(corner[2], corner[0], p);
    return ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)) &&
           lies_in_box(p, corner);
}

enum class Containment { outside, near, inside };

/// Where a point lies relative to a triangle; `near` is outside by up to `slack`.
inline Containment locate(const glm::dvec2& p,
                          const std::array<glm::dvec2, 3>& corner,
                          double slack) {
    if (is_inside(p, corner)) {
        return Containment::inside;
    }
    const double nearest = std::min({squared_distance_to_edge(p, corner[0], corner[1]),
                                     squared_distance_to_edge(p, corner[1], corner[2]),
                                     squared_distance_to_edge(p, corner[2], corner[0])});
    return nearest <= slack * slack ? Containment::near : Containment::outside;
}

}  // namespace earshot::frustum
