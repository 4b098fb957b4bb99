// SPDX-License-Identifier: MIT
#include "earshot/io/internal/ogg_pages.h"

#include "earshot/base/assert.h"

#include <cstddef>
#include <string_view>

namespace earshot::io {

namespace {

// RFC 3533, section 6: fields of a page's header, little-endian.
constexpr std::size_t kSerialAt = 14;
constexpr std::size_t kChecksumAt = 22;
constexpr std::size_t kSegmentCountAt = 26;
constexpr std::size_t kHeaderSize = 27;

std::uint8_t byte_at(std::string_view bytes, std::size_t at) {
    return static_cast<std::uint8_t>(bytes[at]);
}

void put(std::string& bytes, std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[at + i] = static_cast<char>(value >> (8 * i) & 0xFFU);
    }
}

/// The cyclic redundancy check of a page: polynomial 0x04c11db7, initial value 0, no reflection.
std::uint32_t checksum(std::string_view page) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < page.size(); ++i) {
        sum ^= static_cast<std::uint32_t>(byte_at(page, i)) << 24U;
        for (int bit = 0; bit < 8; ++bit) {
            sum = (sum & 0x80000000U) != 0 ? sum << 1U ^ 0x04c11db7U : sum << 1U;
        }
    }
    return sum;
}

}  // namespace

std::string with_serial_number(std::string bytes, std::uint32_t serial) {
    for (std::size_t begin = 0; begin < bytes.size();) {
        EARSHOT_ASSERT(begin + kHeaderSize <= bytes.size() && bytes.compare(begin, 4, "OggS") == 0);
        const std::size_t segments = byte_at(bytes, begin + kSegmentCountAt);
        std::size_t size = kHeaderSize + segments;
        for (std::size_t i = 0; i < segments; ++i) {
            size += byte_at(bytes, begin + kHeaderSize + i);
        }
        EARSHOT_ASSERT(begin + size <= bytes.size());
        put(bytes, begin + kSerialAt, serial);
        put(bytes, begin + kChecksumAt, 0);
        put(bytes, begin + kChecksumAt, checksum(std::string_view(bytes).substr(begin, size)));
        begin += size;
    }
    return bytes;
}

}  // namespace earshot::io
