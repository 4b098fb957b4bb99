// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/propagation/scene.h"

#include <glm/vec2.hpp>

#include <span>

namespace earshot::propagation {

// Rooms without sources and listeners, from their measures. Surfaces face the air, +Y is up, the
// floor is at y = 0; every material absorbs 0.1 and scatters 0.1.

/// A box from the origin to `size`, metres. Materials: "floor", "ceiling", "north" (z = 0), "east"
/// (x = size.x), "south", "west". Throws Error unless the sides are 1e-6 ... 1e9 m.
Scene shoebox_room(const geometry::Vec3& size);

/// Vertical walls of that height, metres, on a floor plan: the corners' x and z, in either sense of
/// rotation. Materials: "floor", "ceiling", "wall 0" from corner 0 to corner 1, "wall 1", ...
/// Throws Error unless the height is 1e-6 ... 1e9 m and the plan is a polygon within 1e9 m of the
/// axes that does not touch or cross itself. O(n^2) for n corners.
Scene extruded_room(std::span<const glm::dvec2> floor_plan, double height);

}  // namespace earshot::propagation
