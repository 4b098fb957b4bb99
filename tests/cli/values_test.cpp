// SPDX-License-Identifier: MIT
#include "earshot/cli/values.h"

#include <gtest/gtest.h>

#include <array>

namespace earshot::cli {
namespace {

TEST(Values, NumbersAreReadWholeOrNotAtAll) {
    EXPECT_EQ(parse_integer("-12"), -12);
    EXPECT_EQ(parse_integer("+3"), 3);
    EXPECT_EQ(parse_number("-.5e1"), -5.0);
    for (const char* text : {"", "x", "1x", " 1", "1 ", "1,5", "++1", "+", "-"}) {
        EXPECT_FALSE(parse_integer(text)) << text;
        EXPECT_FALSE(parse_number(text)) << text;
    }
    EXPECT_FALSE(parse_integer("9223372036854775808"));
    EXPECT_FALSE(parse_integer("1.0"));
    EXPECT_FALSE(parse_number("inf"));
    EXPECT_FALSE(parse_number("nan"));
    EXPECT_FALSE(parse_number("1e999"));
}

TEST(Values, NumbersAreWithinTheirLimits) {
    EXPECT_EQ(parse_integer_within("-2", -2, 3), -2);
    EXPECT_EQ(parse_integer_within("3", -2, 3), 3);
    EXPECT_EQ(parse_number_within("0.5", 0.5, 1.0), 0.5);
    EXPECT_EQ(parse_number_within("1", 0.5, 1.0), 1.0);
    for (const char* text : {"", "x", "-3", "4", "0.25"}) {
        EXPECT_FALSE(parse_integer_within(text, -2, 3)) << text;
        EXPECT_FALSE(parse_number_within(text, 0.5, 1.0)) << text;
    }
}

TEST(Values, ListsHaveTheirNumberOfNumbers) {
    std::array<double, 2> two{};
    ASSERT_TRUE(parse_numbers("1.5;-2", ';', two));
    EXPECT_EQ(two, (std::array<double, 2>{1.5, -2.0}));
    for (const char* text : {"", "1", "1;", ";1", "1;2;", "1;2;3", "1,2", "1;x", "1; 2"}) {
        EXPECT_FALSE(parse_numbers(text, ';', two)) << text;
    }
}

TEST(Values, PointsMayCarryAName) {
    const auto plain = parse_named_point("-0.1,1.68,1.16");
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->name, "");
    EXPECT_EQ(plain->position, (std::array<double, 3>{-0.1, 1.68, 1.16}));
    const auto named = parse_named_point("stage left=1,2,3");
    ASSERT_TRUE(named);
    EXPECT_EQ(named->name, "stage left");
    EXPECT_EQ(named->position, (std::array<double, 3>{1.0, 2.0, 3.0}));
    for (const char* text :
         {"", "1,2", "1,2,3,4", "1,2,", ",,", "=1,2,3", "a=", "1;2;3", "a=1,2,inf"}) {
        EXPECT_FALSE(parse_named_point(text)) << text;
    }
}

TEST(Values, PicturesHaveAWidthAndMaybeAHeight) {
    EXPECT_EQ(parse_picture_size("800", 1000)->width, 800);
    EXPECT_FALSE(parse_picture_size("800", 1000)->height);
    EXPECT_EQ(parse_picture_size("1x1000", 1000)->height, 1000);
    for (const char* text :
         {"", "x", "0", "1001", "10x", "x10", "10x0", "10x1001", "10x10x10", "1.5"}) {
        EXPECT_FALSE(parse_picture_size(text, 1000)) << text;
    }
}

TEST(Values, FramesRunFromTheFirstInstantToTheLast) {
    EXPECT_EQ(parse_frames("0:1:0.25"), (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0}));
    EXPECT_EQ(parse_frames("2:2:1"), (std::vector<double>{2.0}));
    EXPECT_EQ(parse_frames("0:1:0.4")->size(), 3U);
    // 0.1 is not a binary fraction: 10 * 0.1 reaches 1 by rounding only.
    EXPECT_EQ(parse_frames("0:1:0.1")->size(), 11U);
    EXPECT_EQ(parse_frames("0:0.3:0.1")->size(), 4U);
    for (const char* text :
         {"", "0:1", "0:1:0", "0:1:-1", "1:0:1", "0:1e9:1e-3", "a:1:1", "0:1:1:1"}) {
        EXPECT_FALSE(parse_frames(text)) << text;
    }
}

TEST(Values, PointsAndCornersHaveNoNames) {
    using geometry::Vec3;
    EXPECT_EQ(parse_point("1,-2.5,3e2"), Vec3(1.0, -2.5, 300.0));
    for (const char* text : {"", "1,2", "1,2,3,4", "1,2,", "a=1,2,3", "1,2,nan", "1, 2,3"}) {
        EXPECT_FALSE(parse_point(text)) << text;
    }
    EXPECT_EQ(parse_corners("1,2,3:4,5,6"), (std::array{Vec3(1.0, 2.0, 3.0), Vec3(4.0, 5.0, 6.0)}));
    for (const char* text : {"", ":", "1,2,3", "1,2,3:", "1,2,3:4,5", "1,2,3:4,5,6:7,8,9"}) {
        EXPECT_FALSE(parse_corners(text)) << text;
    }
}

}  // namespace
}  // namespace earshot::cli
