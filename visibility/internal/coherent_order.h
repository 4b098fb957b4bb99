// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

// Permutations in which neighbours are close to each other: along a Morton curve (Morton 1966) on a
// coarse grid over the common box, by index within a cell. O(n). Precondition: fewer than 2^32
// elements, all finite.

/// The order of points, on a grid of 256 steps per axis.
std::vector<std::uint32_t> coherent_order(std::span<const geometry::Vec3> points,
                                          Executor& executor = Executor::serial());

/// The order of segments, by both of their ends, on a grid of 16 steps per axis.
std::vector<std::uint32_t> coherent_order(std::span<const geometry::Segment> segments,
                                          Executor& executor = Executor::serial());

}  // namespace earshot::visibility
