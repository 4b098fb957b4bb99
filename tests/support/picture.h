// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace earshot::test {

/// A picture as libpng reads it; 0 x 0 if it cannot.
struct ReadPicture {
    std::size_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;

    std::array<int, 3> at(std::size_t column, std::size_t row) const {
        const std::size_t first = 3 * (row * width + column);
        return {rgb.at(first), rgb.at(first + 1), rgb.at(first + 2)};
    }
};

inline ReadPicture read_picture(const std::filesystem::path& file) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&image, file.c_str()) == 0) {
        ADD_FAILURE() << file << ": " << image.message;
        return {};
    }
    EXPECT_EQ(image.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
    image.format = PNG_FORMAT_RGB;
    ReadPicture picture{.width = image.width, .height = image.height, .rgb = {}};
    picture.rgb.resize(PNG_IMAGE_SIZE(image));
    if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) {
        ADD_FAILURE() << file << ": " << image.message;
        return {};
    }
    return picture;
}

}  // namespace earshot::test
