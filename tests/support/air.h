// SPDX-License-Identifier: MIT
#pragma once

#include "support/dice.h"
#include "support/rooms.h"

namespace earshot::support {

/// Whether a point lies in the air of a room: a ray from it meets the closed surfaces (the shell
/// and the obstacles in it, sheets left out) an odd number of times.
bool is_in_air(const Room& room, const geometry::Vec3& point);

/// Distance to the nearest triangle, metres; infinity if there is none.
double distance_to_walls(const Room& room, const geometry::Vec3& point);

/// A point in the air, at least `clearance` metres from every triangle. Throws std::runtime_error
/// if a thousand throws of the dice find none.
geometry::Vec3 random_air_point(const Room& room, Dice& dice, double clearance = 0.02);

/// A point in the air where decisions are close: the sound of `source`, or of its image in one
/// wall, comes to it through one of the room's openings or past an edge of a triangle, a thousandth
/// of a millimetre from it. Falls back on random_air_point().
geometry::Vec3 aimed_air_point(const Room& room, const geometry::Vec3& source, Dice& dice);

}  // namespace earshot::support
