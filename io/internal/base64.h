// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace earshot::io {

/// Base64 with padding (RFC 4648, section 4).
std::string base64(std::string_view bytes);

/// Of the values, little-endian on any machine.
std::string base64(std::span<const float> values);
std::string base64(std::span<const std::uint32_t> values);
std::string base64(std::span<const std::uint16_t> values);

}  // namespace earshot::io
