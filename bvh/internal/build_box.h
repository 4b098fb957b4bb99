// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace earshot::bvh {

/// A box during a build: `low` holds the negated minima and `high` the maxima, so that one maximum
/// unites boxes. No zero is negative, so that the order of uniting does not show. Trivial on
/// purpose: arrays of it begin uninitialised. Aligned no more than the stack is.
struct alignas(16) BuildBox {
    float low[4];
    float high[4];
};

/// A reference to a primitive: its box, and in the fourth lanes the halves of its index as numbers,
/// since the bits of the index could be a denormal, which is slow to compute with.
using PrimRef = BuildBox;

inline std::uint32_t primitive_index(const PrimRef& ref) noexcept {
    return static_cast<std::uint32_t>(ref.low[3]) |
           (static_cast<std::uint32_t>(ref.high[3]) << 16U);
}

/// Twice the centroid of a box along an axis.
inline float doubled_centroid(const BuildBox& box, std::size_t axis) noexcept {
    return box.high[axis] - box.low[axis];
}

/// A bvh::Node without initialisers.
struct RawNode {
    float lower[3];
    float upper[3];
    std::uint32_t first;
    std::uint32_t count;
};

}  // namespace earshot::bvh
