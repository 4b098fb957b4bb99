// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/aabb.h"

#include <cstdint>
#include <span>

namespace earshot::bvh {

/// A primitive with the Morton code of its centroid, 21 bits per axis.
struct MortonPrimitive {
    std::uint64_t code = 0;
    std::uint32_t index = 0;
};

/// The primitives of all boxes, sorted by code and then by index; boxes[i] is primitive i.
LargeArray<MortonPrimitive> sorted_by_morton_code(std::span<const geometry::Aabb> boxes,
                                                  Executor& executor);

/// The first primitive of [begin, end) whose code has a 1 in the highest bit in which the codes
/// differ; the middle if all are equal. Precondition: sorted, and at least two.
std::uint32_t find_morton_split(std::span<const MortonPrimitive> primitives,
                                std::uint32_t begin,
                                std::uint32_t end) noexcept;

}  // namespace earshot::bvh
