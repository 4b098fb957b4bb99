// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/aabb.h"

#include <cstdint>
#include <span>

namespace earshot::bvh {

/// A primitive with the Morton code of its centroid. Each bit of the code, from the highest on,
/// halves the longest side of a cell, so that flat and long scenes are divided evenly, too.
struct MortonPrimitive {
    std::uint32_t code;
    std::uint32_t index;
};

/// The primitives of all boxes, sorted by code and then by index; boxes[i] is primitive i.
LargeArray<MortonPrimitive> sorted_by_morton_code(std::span<const geometry::Aabb> boxes,
                                                  Executor& executor);

/// The primitives [begin, end) of a node, on the curve.
struct MortonRange {
    std::uint32_t begin = 0, end = 0;
    bool is_one_point = false;  ///< all centroids coincide
    std::uint32_t size() const noexcept { return end - begin; }
};

/// The first primitive of a range whose code has a 1 in the highest bit in which its codes differ.
/// Where the codes of many are equal, because the scene is large and this part of it is small, the
/// range is given codes of its own and sorted by these; the middle if all are equal. Precondition:
/// sorted, and at least two.
std::uint32_t split_morton_range(std::span<const geometry::Aabb> boxes,
                                 std::span<MortonPrimitive> primitives,
                                 MortonRange& range,
                                 Executor& executor);

/// The same without codes of its own: where the codes of a sorted run first differ in their highest
/// differing bit, or the middle.
std::size_t curve_split(std::span<const MortonPrimitive> run) noexcept;

}  // namespace earshot::bvh
