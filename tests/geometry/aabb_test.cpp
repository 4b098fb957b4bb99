// SPDX-License-Identifier: MIT
#include "earshot/geometry/aabb.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

namespace earshot::geometry {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

// The definition, checked from both sides: the bound holds and the next float would not.
void expect_tight(double value) {
    const float down = round_down(value);
    const float up = round_up(value);
    EXPECT_LE(static_cast<double>(down), value) << value;
    EXPECT_GE(static_cast<double>(up), value) << value;
    if (down < kInfinity) {
        EXPECT_GT(static_cast<double>(std::nextafter(down, kInfinity)), value) << value;
    }
    if (up > -kInfinity) {
        EXPECT_LT(static_cast<double>(std::nextafter(up, -kInfinity)), value) << value;
    }
}

TEST(RoundOutward, FindsTheNearestFloatOnEachSideOfAnyDouble) {
    constexpr std::uint64_t kSeed = 4;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const double value = std::bit_cast<double>(random_bits(kSeed, 0, i));
        if (std::isfinite(value)) {
            SCOPED_TRACE(i);
            expect_tight(value);
        }
        const double metres = random_between(kSeed, 1, i, -100.0, 100.0);
        expect_tight(metres);
        expect_tight(std::ldexp(metres, -150));  // among and below float's subnormals
        expect_tight(std::ldexp(metres, 122));   // on both sides of float's largest
    }
}

TEST(RoundOutward, LeavesFloatsAsTheyAre) {
    for (const float value : {0.0F, 1.5F, -0.1F, kLargest, -kLargest, 1e-45F, -1e-45F}) {
        EXPECT_EQ(round_down(static_cast<double>(value)), value);
        EXPECT_EQ(round_up(static_cast<double>(value)), value);
    }
}

TEST(RoundOutward, GoesToInfinityOnlyOutward) {
    EXPECT_EQ(round_down(1e300), kLargest);
    EXPECT_EQ(round_up(1e300), kInfinity);
    EXPECT_EQ(round_down(-1e300), -kInfinity);
    EXPECT_EQ(round_up(-1e300), -kLargest);
    const double just_above = std::nextafter(static_cast<double>(kLargest), 1e300);
    EXPECT_EQ(round_down(just_above), kLargest);
    EXPECT_EQ(round_up(just_above), kInfinity);
    EXPECT_EQ(round_down(5e-324), 0.0F);
    EXPECT_EQ(round_up(5e-324), std::numeric_limits<float>::denorm_min());
    EXPECT_EQ(round_down(-5e-324), -std::numeric_limits<float>::denorm_min());
}

TEST(Aabb, IsEmptyUntilSomethingIsIncluded) {
    Aabb box = Aabb::empty();
    EXPECT_TRUE(box.is_empty());
    EXPECT_EQ(box.half_area(), 0.0);
    box.include(Vec3(1.0, 2.0, 3.0));
    EXPECT_FALSE(box.is_empty());
    EXPECT_EQ(box.lower, box.upper);
    EXPECT_EQ(box.half_area(), 0.0);
    Aabb other;
    other.include(box);
    EXPECT_EQ(other, box);
    other.include(Aabb::empty());
    EXPECT_EQ(other, box);
}

TEST(Aabb, ContainsEveryIncludedPoint) {
    constexpr std::uint64_t kSeed = 5;
    Aabb box;
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; i < 300; ++i) {
        points.emplace_back(random_between(kSeed, 0, i, -9.0, -1.0),
                            random_between(kSeed, 1, i, -1.0, 7.0),
                            random_between(kSeed, 2, i, 1e-3, 2e-3));
        box.include(points.back());
    }
    for (const Vec3& point : points) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double x = point[static_cast<int>(k)];
            EXPECT_LE(static_cast<double>(box.lower[k]), x);
            EXPECT_GE(static_cast<double>(box.upper[k]), x);
        }
    }
}

TEST(Aabb, HalvesTheSurfaceArea) {
    Aabb box;
    box.include(Vec3(-1.0, 0.0, 2.0));
    box.include(Vec3(1.0, 3.0, 6.0));
    EXPECT_EQ(box.half_area(), 2.0 * 3.0 + 3.0 * 4.0 + 4.0 * 2.0);
}

TEST(Aabb, FindsItsLargestCoordinate) {
    EXPECT_EQ(Aabb::empty().max_abs_coordinate(), 0.0);
    Aabb box;
    box.include(Vec3(-1.0, 3.0, -6.0));
    box.include(Vec3(1.0, -2.0, 5.0));
    EXPECT_EQ(box.max_abs_coordinate(), 6.0);
}

}  // namespace
}  // namespace earshot::geometry
