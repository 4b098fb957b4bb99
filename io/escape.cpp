// SPDX-License-Identifier: MIT
#include "earshot/io/escape.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace earshot::io {
namespace {

/// A character of UTF-8 and its length in bytes; length 0 where the bytes are none.
struct Character {
    std::uint32_t code = 0;
    std::size_t length = 0;
};

/// RFC 3629 section 3: no overlong forms, no surrogates, at most U+10FFFF.
Character first_character(std::string_view text) noexcept {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::uint32_t lead = byte(0);
    if (lead < 0x80) {
        return {lead, 1};
    }
    const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    constexpr std::array<std::uint32_t, 5> kMinCode{0, 0, 0x80, 0x800, 0x10000};
    if (lead < 0xC2 || lead > 0xF4 || text.size() < length) {
        return {};
    }
    std::uint32_t code = lead & (0x7FU >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0U) != 0x80) {
            return {};
        }
        code = code << 6U | (byte(i) & 0x3FU);
    }
    const bool is_valid =
        code >= kMinCode[length] && code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
    return is_valid ? Character{code, length} : Character{};
}

bool is_control(std::uint32_t code) noexcept {
    const bool is_c0_or_c1 = code < 0x20 || (code >= 0x7F && code <= 0x9F);
    const bool is_separator = code == 0x2028 || code == 0x2029;
    const bool is_direction = code == 0x200E || code == 0x200F || code == 0x061C ||
                              (code >= 0x202A && code <= 0x202E) ||
                              (code >= 0x2066 && code <= 0x2069);
    return is_c0_or_c1 || is_separator || is_direction;
}

std::string escape(const char* format, std::uint32_t code) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), format, static_cast<unsigned>(code));
    return text.data();
}

}  // namespace

std::string escape_controls(std::string_view text, bool keep_line_feeds) {
    const auto is_plain = [=](char c) {
        return (c >= 0x20 && c < 0x7F) || (c == '\n' && keep_line_feeds);
    };
    std::string escaped;
    escaped.reserve(text.size());
    while (!text.empty()) {
        // Nearly all text is plain ASCII, which is copied in runs.
        const auto run = static_cast<std::size_t>(
            std::find_if_not(text.begin(), text.end(), is_plain) - text.begin());
        escaped += text.substr(0, run);
        text.remove_prefix(run);
        if (text.empty()) {
            break;
        }
        const Character character = first_character(text);
        const std::size_t length = character.length == 0 ? 1 : character.length;
        if (character.length == 0) {
            escaped += escape("\\x%02x", static_cast<unsigned char>(text.front()));
        } else if (is_control(character.code)) {
            escaped += escape("\\u%04x", character.code);
        } else {
            escaped += text.substr(0, length);
        }
        text.remove_prefix(length);
    }
    return escaped;
}

}  // namespace earshot::io
