// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"

namespace earshot {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014): the golden-ratio increment and the variant-13 mixer.
std::uint64_t mix(std::uint64_t value) noexcept {
    value += 0x9e3779b97f4a7c15ULL;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
    return value ^ (value >> 31);
}

}  // namespace

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
    return mix(mix(mix(seed) ^ stream) ^ index);
}

double random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
    constexpr double kUnit = 0x1p-53;
    return static_cast<double>(random_bits(seed, stream, index) >> 11) * kUnit;
}

double random_between(std::uint64_t seed,
                      std::uint64_t stream,
                      std::uint64_t index,
                      double low,
                      double high) noexcept {
    return low + (high - low) * random(seed, stream, index);
}

}  // namespace earshot
