// SPDX-License-Identifier: MIT
#include "earshot/base/digest.h"

namespace earshot {

void Digest::add_bytes(std::span<const std::byte> bytes) noexcept {
    constexpr std::uint64_t kPrime = 0x100000001b3ULL;
    for (const std::byte byte : bytes) {
        value_ = (value_ ^ static_cast<std::uint64_t>(byte)) * kPrime;
    }
}

}  // namespace earshot
