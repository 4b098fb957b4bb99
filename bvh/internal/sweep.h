// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::bvh {

/// Costs of cutting a sorted range, times the half area of its box: element j is that of leaving
/// its first j boxes, order[0 ... j - 1], on the left, for 0 < j < order.size(). Element 0 is that
/// of no cut. Every side counts as a leaf: its number of boxes times its half area.
void sweep_costs(std::span<const geometry::Aabb> boxes,
                 std::span<const std::uint32_t> order,
                 std::span<double> costs);

}  // namespace earshot::bvh
