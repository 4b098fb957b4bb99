// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"
#include "earshot/bvh/wide_tree.h"

#include <cstdint>
#include <vector>

namespace earshot::bvh {

/// The node of the binary tree that fills each slot of the wide tree built of it: their areas are
/// what the wide tree costs. A leaf that two slots share is listed twice. O(n).
std::vector<std::uint32_t> slot_nodes(const Tree& tree, const WideTree& wide);

/// sah_cost() of the wide tree, from the boxes of the binary tree; infinite if that has no area.
double sah_cost(const Tree& tree, const std::vector<std::uint32_t>& slot_nodes) noexcept;

}  // namespace earshot::bvh
