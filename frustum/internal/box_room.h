// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/scene_view.h"

#include <array>
#include <cstddef>
#include <optional>

namespace earshot::frustum {

/// A scene that is a box of six whole walls and nothing else, and by how much it misses the ideal
/// one: walls of a turned room stand on corners that files round.
struct BoxRoom {
    std::array<geometry::Vec3, 3> axes;  ///< unit and perpendicular
    std::array<double, 3> low{};         ///< metres along the axes, of the walls
    std::array<double, 3> high{};
    std::array<std::array<geometry::FacetId, 2>, 3>
        walls{};         ///< per axis: the low and the high one
    double tilt = 0.0;   ///< largest length of the difference of a wall's normal and its axis
    double error = 0.0;  ///< metres: how far walls, their corners and triangles lie off the ideal

    double size(std::size_t axis) const noexcept { return high[axis] - low[axis]; }
    /// Whether all walls are coordinate planes, to the bit: there, mirroring changes one coordinate
    /// and no other.
    bool is_straight() const noexcept;
    /// Coordinates along the axes, from the low walls on.
    std::array<double, 3> local(const geometry::Vec3& point) const noexcept;
};

/// The box that a scene is. Judged by its geometry alone: six facets, each of one rectangular
/// outline between the same eight corners, in pairwise perpendicular or parallel planes. A wall of
/// two materials, a hole, a gap, a table, a poster or a doubled wall makes other facets than these,
/// and no box; nor does a wall that sound passes, or one that does not reflect to the inside.
std::optional<BoxRoom> find_box_room(const SceneView& scene);

}  // namespace earshot::frustum
