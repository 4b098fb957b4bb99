// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace earshot::bvh {

/// A box as builders move it about: `low` holds the negated minima and `high` the maxima, so that
/// one maximum joins boxes. The fourth lanes are free; in a reference to a primitive they hold the
/// halves of its index as numbers, since its bits could be a denormal, which is slow to compute
/// with. No zero is negative, so that the order of joining does not show. Trivial on purpose:
/// arrays of it begin uninitialised. Aligned no more than the stack is.
struct alignas(16) WideBox {
    float low[4];
    float high[4];
};

/// The index of a reference to a primitive.
inline std::uint32_t index_of(const WideBox& ref) noexcept {
    return static_cast<std::uint32_t>(ref.low[3]) |
           (static_cast<std::uint32_t>(ref.high[3]) << 16U);
}

/// Twice the centre of a box along an axis.
inline float centre_of(const WideBox& box, std::size_t axis) noexcept {
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
