// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace earshot::io {

/// Rows from the top down, pixels from left to right: red, green and blue (sRGB), a byte each.
struct Picture {
    std::size_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

/// The longest edge of a picture.
inline constexpr std::size_t kMaxPictureSize = 8192;

/// The bytes of a PNG file. Preconditions: width and height are 1 ... kMaxPictureSize, and there
/// are three bytes per pixel. Throws Error if memory is short.
std::string encode_png(const Picture& picture);

/// Writes it whole or not at all. Throws Error as write_whole_file() and encode_png().
void write_png(const std::filesystem::path& file, const Picture& picture);

}  // namespace earshot::io
