// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/wide_tree.h"

#include <optional>

namespace earshot::bvh {

// Compiled for every instruction set. Precondition: the tree is not empty.

/// False: the ray lies outside the range of FloatRay, and nothing was searched. What was added to
/// the search last is still to be settled.
bool find_closest(const WideTree& tree,
                  const geometry::Ray& ray,
                  double reach,
                  ClosestHitSearch& search) noexcept;

/// Empty: the segment lies outside the range of FloatRay.
std::optional<bool> find_any(const WideTree& tree,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             double reach) noexcept;

}  // namespace earshot::bvh
