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

}  // namespace earshot::support
