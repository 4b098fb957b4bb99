// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace earshot {

/// The 32 bytes of a SHA-256 digest.
using Sha256Digest = std::array<std::uint8_t, 32>;

/// SHA-256 (FIPS 180-4) of bytes that come piece by piece.
class Sha256 {
public:
    void add(std::string_view bytes) noexcept;

    /// The digest of all bytes. To be called once, as the last.
    Sha256Digest finish() noexcept;

private:
    void compress(const std::uint8_t* block) noexcept;

    std::array<std::uint32_t, 8> state_{0x6a09e667,
                                        0xbb67ae85,
                                        0x3c6ef372,
                                        0xa54ff53a,
                                        0x510e527f,
                                        0x9b05688c,
                                        0x1f83d9ab,
                                        0x5be0cd19};
    std::array<std::uint8_t, 64> block_{};  ///< the bytes that do not fill a block yet
    std::uint64_t size_ = 0;                ///< bytes so far
};

/// The digest of bytes at once.
Sha256Digest sha256(std::string_view bytes) noexcept;

/// 64 digits in lower case.
std::string hex_text(const Sha256Digest& digest);

}  // namespace earshot
