// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace earshot::frustum {

inline constexpr std::size_t kMaxHalfSpaces = 8;

/// Up to eight half-spaces normal . x >= offset, a component per row; unused ones hold zeros and
/// offset -1, which nothing violates. Positive and negative parts of the normals stand apart, so
/// that the corner of a box farthest along a normal needs no selection.
struct alignas(64) HalfSpaces {
    double positive[3][kMaxHalfSpaces] = {};
    double negative[3][kMaxHalfSpaces] = {};
    double offset[kMaxHalfSpaces] = {-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0};
};

/// Whether a box lies wholly outside one of the half-spaces. The same bits on every instruction
/// set.
bool lies_outside(const HalfSpaces& half_spaces, const float* lower, const float* upper);

}  // namespace earshot::frustum
