// SPDX-License-Identifier: MIT
#include "earshot/io/internal/base64.h"

#include "earshot/io/internal/bytes.h"

#include <bit>

namespace earshot::io {

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
            group = group << 8U | byte;
        }
        text += kDigits[group >> 18U];
        text += kDigits[group >> 12U & 0x3fU];
        text += i + 1 < bytes.size() ? kDigits[group >> 6U & 0x3fU] : '=';
        text += i + 2 < bytes.size() ? kDigits[group & 0x3fU] : '=';
    }
    return text;
}

std::string base64(std::span<const float> values) {
    ByteWriter bytes;
    for (const float value : values) {
        bytes.fixed(std::bit_cast<std::uint32_t>(value), 4);
    }
    return base64(bytes.bytes());
}

std::string base64(std::span<const std::uint32_t> values) {
    ByteWriter bytes;
    for (const std::uint32_t value : values) {
        bytes.fixed(value, 4);
    }
    return base64(bytes.bytes());
}

std::string base64(std::span<const std::uint16_t> values) {
    ByteWriter bytes;
    for (const std::uint16_t value : values) {
        bytes.fixed(value, 2);
    }
    return base64(bytes.bytes());
}

}  // namespace earshot::io
