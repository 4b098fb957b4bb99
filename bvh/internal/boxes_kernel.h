// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/internal/morton.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <span>

namespace earshot::bvh {

// Boxes, compiled once per instruction set. All compute the same bits; no zero is negative.

/// Sets boxes[i] to the box of triangle first + i, rounded outward.
void set_triangle_boxes(const geometry::MeshView& mesh,
                        std::size_t first,
                        std::span<geometry::Aabb> boxes);

/// The union of the boxes of some primitives, of which there is one at least.
geometry::Aabb united_box(std::span<const geometry::Aabb> boxes,
                          std::span<const MortonPrimitive> primitives);

}  // namespace earshot::bvh
