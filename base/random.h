// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace earshot {

/// 64 random bits that are a pure function of the three keys: no state to share or to advance, so
/// item `index` gets the same number on any thread and in any order. SplitMix64's finaliser (Steele
/// et al. 2014) applied to each key in turn.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept;

/// Uniform in [0, 1), a multiple of 2^-53.
double random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept;

/// Uniform in [low, high].
double random_between(std::uint64_t seed,
                      std::uint64_t stream,
                      std::uint64_t index,
                      double low,
                      double high) noexcept;

}  // namespace earshot
