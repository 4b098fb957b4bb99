// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace earshot::io {

/// An Ogg stream whose pages have this serial number, and checksums to match (RFC 3533). Encoders
/// draw the number at random, so that the same sound would have other bytes each time.
/// Precondition: `bytes` are whole pages of one logical stream.
std::string with_serial_number(std::string bytes, std::uint32_t serial);

}  // namespace earshot::io
