// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstdint>

namespace earshot {

/// Element `index` of the low-discrepancy sequence of a base, in [0, 1): the digits of the index
/// mirrored at the point (Halton 1960). Coordinates of one point take the first primes as bases.
/// Precondition: base > 1.
double radical_inverse(std::uint64_t index, std::uint32_t base) noexcept;

/// The same shifted modulo 1 (Cranley and Patterson 1976): other seeds give other points of the
/// same discrepancy. Precondition: shift in [0, 1).
double shifted_radical_inverse(std::uint64_t index, std::uint32_t base, double shift) noexcept;

}  // namespace earshot
