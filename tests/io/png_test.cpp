// SPDX-License-Identifier: MIT
#include "earshot/io/png.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/picture.h"
#include "support/temporary_folder.h"
#include <fstream>
#include <utility>

namespace earshot::io {
namespace {

/// Every byte differs from its neighbours.
Picture some_picture(std::size_t width, std::size_t height) {
    Picture picture{.width = width, .height = height, .rgb = {}};
    for (std::size_t i = 0; i < 3 * width * height; ++i) {
        picture.rgb.push_back(static_cast<std::uint8_t>(i * i * 31 + i * 7));
    }
    return picture;
}

TEST(Png, HoldsThePixelsThatWereGiven) {
    const test::TemporaryFolder folder;
    for (const auto& [width, height] :
         std::initializer_list<std::pair<std::size_t, std::size_t>>{{1, 1}, {3, 2}, {640, 7}}) {
        const Picture picture = some_picture(width, height);
        write_png(folder.path() / "a.png", picture);
        const test::ReadPicture read = test::read_picture(folder.path() / "a.png");
        EXPECT_EQ(read.width, width);
        EXPECT_EQ(read.height, height);
        EXPECT_EQ(read.rgb, picture.rgb);
    }
}

TEST(Png, IsTheSameBytesEveryTime) {
    EXPECT_EQ(encode_png(some_picture(300, 200)), encode_png(some_picture(300, 200)));
}

TEST(Png, SaysWhereItCannotBeWritten) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(write_png(folder.path() / "absent" / "a.png", some_picture(2, 2)), Error);
    EXPECT_THROW(write_png(folder.path(), some_picture(2, 2)), Error);
}

}  // namespace
}  // namespace earshot::io
