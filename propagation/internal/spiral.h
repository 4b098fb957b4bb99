// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/mat3x3.hpp>

#include <cstdint>

namespace earshot::propagation {

/// Direction `i` of `count` on a spiral that covers the sphere evenly, by the golden ratio.
geometry::Vec3 spiral_direction(std::uint64_t i, double count) noexcept;

/// A rotation drawn evenly from all rotations (Shoemake 1992): a pure function of its keys.
glm::dmat3 random_rotation(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept;

}  // namespace earshot::propagation
