// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"

namespace earshot {
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
    return RandomStream(seed, stream).bits(index);
}

double random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
    return RandomStream(seed, stream).at(index);
}

double random_between(std::uint64_t seed,
                      std::uint64_t stream,
                      std::uint64_t index,
                      double low,
                      double high) noexcept {
    return low + (high - low) * random(seed, stream, index);
}

}  // namespace earshot
