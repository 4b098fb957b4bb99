// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstdint>

namespace earshot {

/// 64 random bits that are a pure function of the three keys: no state to share or to advance, so
/// item `index` gets the same number on any thread and in any order. SplitMix64's finaliser (Steele
/// et al. 2014) applied to each key in turn.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept;

/// random_bits() of one seed and one stream, for many indices.
class RandomStream {
public:
    RandomStream(std::uint64_t seed, std::uint64_t stream) noexcept
        : key_(mix(mix(seed) ^ stream)) {}

    std::uint64_t bits(std::uint64_t index) const noexcept { return mix(key_ ^ index); }
    /// As random().
    double at(std::uint64_t index) const noexcept {
        return static_cast<double>(bits(index) >> 11) * 0x1p-53;
    }

private:
    // SplitMix64: the golden-ratio increment and the variant-13 mixer.
    static std::uint64_t mix(std::uint64_t value) noexcept {
        value += 0x9e3779b97f4a7c15ULL;
        value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
        value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
        return value ^ (value >> 31);
    }

    std::uint64_t key_;
};

/// Uniform in [0, 1), a multiple of 2^-53.
double random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept;

/// Uniform in [low, high].
double random_between(std::uint64_t seed,
                      std::uint64_t stream,
                      std::uint64_t index,
                      double low,
                      double high) noexcept;

}  // namespace earshot
