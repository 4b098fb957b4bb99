// SPDX-License-Identifier: MIT
#include "earshot/geometry/vector.h"

#include "earshot/geometry/interval.h"
#include "earshot/geometry/mesh.h"

#include <gtest/gtest.h>

#include <limits>

namespace earshot::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(IsFinite, IsFalseForEveryComponentThatIsNot) {
    EXPECT_TRUE(is_finite(Vec3(1e308, -1e308, 0.0)));
    EXPECT_TRUE(is_finite(glm::dmat3(1.0)));
    EXPECT_TRUE(is_finite(glm::dmat4(1.0)));
    for (const double bad : {kInfinity, -kInfinity, kNotANumber}) {
        for (int column = 0; column < 4; ++column) {
            for (int row = 0; row < 4; ++row) {
                glm::dmat4 four(1.0);
                four[column][row] = bad;
                EXPECT_FALSE(is_finite(four));
                if (column < 3 && row < 3) {
                    glm::dmat3 three(1.0);
                    three[column][row] = bad;
                    EXPECT_FALSE(is_finite(three));
                    EXPECT_FALSE(is_finite(three[column]));
                }
            }
        }
    }
}

TEST(MaxAbs, IsTheLargestComponentWithoutItsSign) {
    EXPECT_EQ(max_abs({1.0, -3.0, 2.0}), 3.0);
    EXPECT_EQ(max_abs({-4.0, 3.0, 2.0}), 4.0);
    EXPECT_EQ(max_abs({0.0, -0.0, -5.0}), 5.0);
}

TEST(LexicographicLess, ComparesByXThenYThenZ) {
    EXPECT_TRUE(lexicographic_less({0, 9, 9}, {1, 0, 0}));
    EXPECT_TRUE(lexicographic_less({1, 0, 9}, {1, 1, 0}));
    EXPECT_TRUE(lexicographic_less({1, 1, 0}, {1, 1, 1}));
    EXPECT_FALSE(lexicographic_less({1, 1, 1}, {1, 1, 1}));
    EXPECT_FALSE(lexicographic_less({0.0, 0, 0}, {-0.0, 0, 0}));
    EXPECT_FALSE(lexicographic_less({-0.0, 0, 0}, {0.0, 0, 0}));
}

TEST(Normalized, HasLengthOneAndTheSameDirection) {
    EXPECT_EQ(normalized({3.0, 0.0, 4.0}), Vec3(0.6, 0.0, 0.8));
    EXPECT_FALSE(is_finite(normalized(Vec3(0.0))));
    EXPECT_EQ(normalized_or_zero({3.0, 0.0, 4.0}), Vec3(0.6, 0.0, 0.8));
    EXPECT_EQ(normalized_or_zero(Vec3(0.0)), Vec3(0.0));
    EXPECT_EQ(normalized_or_zero({1e200, 0.0, 0.0}),
              Vec3(0.0));  // the square of its length overflows
}

TEST(DirectionBetween, LeadsFromTheFirstPointToTheSecond) {
    EXPECT_EQ(direction_between({1.0, 2.0, 3.0}, {1.0, 7.0, 3.0}), Vec3(0.0, 1.0, 0.0));
    EXPECT_EQ(direction_between(Vec3(2.0), Vec3(2.0)), Vec3(0.0));
}

TEST(Interval, IsEmptyOnlyIfItEndsBeforeItBegins) {
    EXPECT_FALSE((Interval{0.0, 1.0}.is_empty()));
    EXPECT_FALSE((Interval{1.0, 1.0}.is_empty()));
    EXPECT_TRUE((Interval{1.0, 0.0}.is_empty()));
}

TEST(Corners, AreThePositionsOfATrianglesVerticesInOrder) {
    const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {3, 1, 0}}};
    const Corners expected{Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, 0)};
    EXPECT_EQ(corners(mesh, 1), expected);
    EXPECT_EQ(corners(mesh.view(), 1), expected);
    EXPECT_EQ(corners(mesh.positions, mesh.triangles[1]), expected);
}

}  // namespace
}  // namespace earshot::geometry
