// SPDX-License-Identifier: MIT
#include "earshot/io/points.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <fstream>
#include <string>

namespace earshot::io {
namespace {

using geometry::Vec3;

class Points : public testing::Test {
protected:
    std::filesystem::path file_of(const std::string& text) const {
        const auto file = folder_.path() / "points.csv";
        std::ofstream(file, std::ios::binary) << text;
        return file;
    }

    /// The message of the error that reading the text ends in.
    std::string error_of(const std::string& text) const {
        try {
            read_points(file_of(text));
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }

    const test::TemporaryFolder folder_;
};

TEST_F(Points, AreReadWithOrWithoutHeader) {
    const std::vector<Vec3> expected{{1.0, 2.5, -3.0}, {4e-3, 0.0, 7.0}};
    EXPECT_EQ(read_points(file_of("1,2.5,-3\n4e-3,0,7\n")), expected);
    EXPECT_EQ(read_points(file_of("x,y,z\r\n 1 , 2.5, -3\r\n\r\n4e-3,0,7")), expected);
}

TEST_F(Points, AreRefusedWithTheLine) {
    EXPECT_NE(error_of("x,y,z\n1,2,3\n1,2\n").find("line 3"), std::string::npos);
    EXPECT_NE(error_of("1,2,3,4\n").find("line 1"), std::string::npos);
    EXPECT_NE(error_of("1,2,3\nx,y,z\n").find("line 2"), std::string::npos);
    EXPECT_NE(error_of("1,2,nan\n").find("line 1"), std::string::npos);
    EXPECT_NE(error_of("1,2,1e13\n").find("line 1"), std::string::npos);
    EXPECT_NE(error_of("x,y,z\n").find("no points"), std::string::npos);
    EXPECT_NE(error_of("").find("no points"), std::string::npos);
    EXPECT_THROW(read_points(folder_.path() / "absent.csv"), Error);
}

}  // namespace
}  // namespace earshot::io
