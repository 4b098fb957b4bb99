// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <optional>

namespace earshot::bvh {

// Compiled for every instruction set. Precondition: the tree is not empty.

/// False: the ray lies outside the range of FloatRay, and nothing was searched.
bool find_closest(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  const geometry::Ray& ray,
                  std::optional<geometry::Hit>& hit) noexcept;

/// Empty: the segment lies outside the range of FloatRay.
std::optional<bool> find_any(const WideTree& tree,
                             const geometry::MeshView& mesh,
                             const geometry::Segment& segment,
                             double reach) noexcept;

}  // namespace earshot::bvh
