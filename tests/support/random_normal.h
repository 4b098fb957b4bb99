// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace earshot::test {

/// A number from the standard normal distribution, a pure function of its keys (Box and Muller
/// 1958).
inline double random_normal(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - random(seed, stream, 2 * index)));
    return radius * std::cos(2.0 * std::numbers::pi * random(seed, stream, 2 * index + 1));
}

}  // namespace earshot::test
