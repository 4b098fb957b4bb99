// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/aabb.h"

#include <cstdint>
#include <span>

namespace earshot::bvh {

/// A box's place along a Morton curve through the centres: 21 bits per axis.
struct MortonPrimitive {
    std::uint64_t code = 0;
    std::uint32_t index = 0;
};

/// The places of all boxes, sorted by code and then by index.
LargeArray<MortonPrimitive> sorted_by_morton_code(std::span<const geometry::Aabb> boxes,
                                                  Executor& executor);

/// Where the highest bit in which codes of [begin, end) differ turns to 1; the middle if all are
/// equal. Precondition: sorted, and at least two.
std::uint32_t find_morton_split(std::span<const MortonPrimitive> places,
                                std::uint32_t begin,
                                std::uint32_t end) noexcept;

}  // namespace earshot::bvh
