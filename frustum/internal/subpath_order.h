// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/subpath_tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// The numbers of subpaths in an order in which neighbours are close: halves of the order, halves
/// of those and so on are parted by a coordinate of their places (a balanced k-d tree, Bentley
/// 1975). Parts begin at multiples of their size, a power of two. The same order for any executor.
std::vector<std::uint32_t> order_subpaths(std::span<const SubpathBounds> subpaths,
                                          Executor& executor);

}  // namespace earshot::frustum
