// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/types.h"

#include <array>
#include <cstdint>

namespace earshot::geometry {

/// A point in the cylindrical coordinates of a wedge.
struct WedgePoint {
    double radius = 0.0;  ///< metres from the line of the edge
    double angle = 0.0;   ///< radians through the air from the first face, in [0, 2 pi)
    double z = 0.0;       ///< metres along the edge from its beginning; any sign
};

/// A side of a facet.
struct WedgeFace {
    FacetId facet = 0;
    bool is_front = true;  ///< the side that the facet's normal points to
    friend bool operator==(const WedgeFace&, const WedgeFace&) = default;
};

/// A straight edge with two faces that meet there, and the air between them. Angles run through the
/// air, from 0 on the first face to `open_angle` on the second. A thin plate has an open angle of
/// 2 pi; both faces are sides of one facet.
struct Wedge {
    Vec3 begin{0.0};
    Vec3 end{0.0, 0.0, 1.0};
    Vec3 direction{0.0, 0.0, 1.0};  ///< unit vector from begin to end
    Vec3 tangent{1.0, 0.0, 0.0};    ///< unit vector in the first face, perpendicular to the edge
    Vec3 normal{0.0, 1.0, 0.0};     ///< unit normal of the first face, into the air
    double open_angle = 0.0;        ///< radians, in (0, 2 pi]
    std::array<WedgeFace, 2> faces{};

    /// Metres.
    double length() const noexcept;
    /// The point of the edge's line at a distance from its beginning.
    Vec3 point_at(double z) const noexcept { return begin + z * direction; }
};

/// Where a point lies about a wedge. Points on the first face from below rounding have angles near
/// 2 pi: which side of a thin plate a point lies on is for the caller to decide.
WedgePoint wedge_coordinates(const Wedge& wedge, const Vec3& point) noexcept;

/// A wedge of this open angle whose edge runs from `begin` to `end`; the first face contains the
/// point `in_first_face`, and the air lies to the side of it that the angle turns to, counter-
/// clockwise about the edge's direction. Precondition: the three points are not on one line.
Wedge make_wedge(const Vec3& begin, const Vec3& end, const Vec3& in_first_face, double open_angle);

}  // namespace earshot::geometry
