// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// Per point 1 if another point lies within `distance` metres; some more may be marked where many
/// points crowd. Those of which `takes_part` is 0 are ignored. O(n). Preconditions: `distance` is
/// positive and at least 2^-24 of the largest coordinate; finite; fewer than 2^32 - 1 points.
std::vector<std::uint8_t> mark_close_points(std::span<const Vec3> points,
                                            std::span<const std::uint8_t> takes_part,
                                            double distance);

}  // namespace earshot::geometry
