// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/box_cull.h"
#include "earshot/frustum/internal/coverage_raster.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/facets.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <vector>

namespace earshot::frustum {

/// In (u, v): an aperture grows by this on every side, so that rounding in its corners (a few 2^-53
/// of coordinates below 2) loses nothing.
inline constexpr double kApertureSlack = 0x1p-44;

/// geometry::Plane::distance, inline.
inline double height_above(const geometry::Plane& plane, const geometry::Vec3& point) noexcept {
    return glm::dot(plane.normal, point) - plane.offset;
}

/// A linear function of (u, v): the inverse depth at which a frustum's rays meet a plane. Larger is
/// closer; negative is behind the apex.
struct InverseDepth {
    double constant = 0.0;
    glm::dvec2 slope{0.0};

    double at(const glm::dvec2& uv) const noexcept {
        return constant + slope.x * uv.x + slope.y * uv.y;
    }
    double min(const Rect& rect) const noexcept {
        return at(0.5 * (rect.lower + rect.upper)) - half_range(rect);
    }
    double max(const Rect& rect) const noexcept {
        return at(0.5 * (rect.lower + rect.upper)) + half_range(rect);
    }
    /// Half the variation over a rectangle.
    double half_range(const Rect& rect) const noexcept {
        const glm::dvec2 half = 0.5 * (rect.upper - rect.lower);
        return std::abs(slope.x) * half.x + std::abs(slope.y) * half.y;
    }
    friend bool operator==(const InverseDepth&, const InverseDepth&) = default;
};

/// Slack for the rounding of (u, v), in cells, in addition to the slack that depends on a polygon's
/// depth.
inline constexpr double kCellSlack = 0x1p-30;

/// A bound of the error of u (or v) times depth, in metres per metre of position error. The error
/// is at most 1 + |u|, and |u| <= 1 in the grid. The factor is twice that, because outlines are
/// moved along a coordinate axis, by up to sqrt(3) times their distance from the plane.
inline constexpr double kProjectionErrorFactor = 4.0;

/// A beam: a four-sided pyramid with its apex in a source or an image source, truncated at the
/// facet that it was last mirrored in. Directions are w + u * right + v * up with (u, v) in `rect`,
/// divided into cells x cells sub-frusta of which those in `active` are traced.
///
/// Mirroring a frustum mirrors apex and axes, so (u, v) of a direction never changes along a
/// sequence of reflections: an aperture cut from the parent's rectangle is the child's rectangle.
///
/// A point at depth t is apex + t (forward + u right + v up); put into a plane's equation and
/// solved for 1 / t, that is the plane's InverseDepth.
struct Frustum {
    geometry::Vec3 apex{0.0};
    geometry::Vec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0}, forward{0.0, 0.0, 1.0};
    Rect rect;
    int cells = kGridSide;
    CellMask active = kAllCells;

    bool starts_at_facet = false;
    geometry::FacetId facet = 0;       ///< where it starts, if it does
    double side = 1.0;                 ///< +1: the facet's front reflects, -1: its back
    InverseDepth start{};              ///< of the facet's plane
    double max_pressure_factor = 1.0;  ///< of the reflections so far
    double min_depth = 0.0;            ///< along `forward`: nothing closer belongs to the frustum

    /// Coordinates along (right, up, forward) relative to the apex.
    geometry::Vec3 local(const geometry::Vec3& point) const noexcept {
        const geometry::Vec3 offset = point - apex;
        return {glm::dot(offset, right), glm::dot(offset, up), glm::dot(offset, forward)};
    }
    /// `height`: of the apex above the plane.
    InverseDepth inverse_depth(const geometry::Plane& plane, double height) const noexcept {
        const double scale = -1.0 / height;
        return {
            .constant = scale * glm::dot(plane.normal, forward),
            .slope = {scale * glm::dot(plane.normal, right), scale * glm::dot(plane.normal, up)}};
    }
    InverseDepth inverse_depth(const geometry::Plane& plane) const noexcept {
        return inverse_depth(plane, height_above(plane, apex));
    }

    friend bool operator==(const Frustum&, const Frustum&) = default;
};

/// The frusta that together cover every direction from a point: six faces of a cube, each cut into
/// `pieces` x `pieces` with a grid of `cells` x `cells`. `min_depth` in metres.
std::vector<Frustum> frusta_around(const geometry::Vec3& source,
                                   int pieces,
                                   int cells,
                                   double min_depth);

/// The frustum mirrored in a plane, restricted to an aperture in the parent's (u, v) rectangle. All
/// cells of the new grid are active. Precondition: the apex is not in the plane.
Frustum mirrored(const Frustum& parent,
                 const geometry::Plane& plane,
                 geometry::FacetId facet,
                 const Rect& aperture);

/// Culls boxes that do not overlap a frustum. Conservative: `slack` metres of rounding on either
/// side.
class BoxCull {
public:
    BoxCull(const Frustum& frustum, const geometry::Plane* start_plane, double slack) noexcept;

    bool may_overlap(const geometry::Aabb& box) const noexcept {
        return !lies_outside(half_spaces_, box.lower.data(), box.upper.data());
    }

    /// Five, in the first places.
    const HalfSpaces& half_spaces() const noexcept { return half_spaces_; }

private:
    HalfSpaces half_spaces_;
};

}  // namespace earshot::frustum
