// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/lambert.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

TEST(Lambert, PointsOnTheCircleAreThoseOfTheLibrary) {
    constexpr double kTurn = 2.0 * 3.14159265358979323846;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const auto turns = static_cast<std::uint32_t>(random_bits(1, 0, i));
        const auto [c, s] = point_on_circle(turns);
        // A quarter's middle is an eighth of a turn on.
        const double angle = kTurn * ((turns + 0.5) * 0x1p-32 - 0.125);
        ASSERT_NEAR(c, std::cos(angle), 1e-13) << turns;
        ASSERT_NEAR(s, std::sin(angle), 1e-13) << turns;
    }
}

// The cosine to the normal has the density 2 cos: its mean is 2/3, that of its square 1/2, and that
// of its fourth power 1/3. Across the normal all is even: means 0, squares 1/4 each.
TEST(Lambert, DirectionsHaveTheMomentsOfTheCosineLaw) {
    constexpr std::uint64_t kCount = 200000;
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(-3, 2, -6) / 7.0}) {
        const Vec3 other = glm::normalize(glm::cross(axis, Vec3(0.3, -0.5, 0.9)));
        double first = 0.0, second = 0.0, fourth = 0.0, across = 0.0, across_squared = 0.0;
        for (std::uint64_t i = 0; i < kCount; ++i) {
            const Vec3 direction = lambert_direction(axis, random_bits(2, 0, i));
            ASSERT_NEAR(glm::length(direction), 1.0, 1e-12);
            const double cosine = glm::dot(direction, axis);
            ASSERT_GT(cosine, 0.0);
            const double side = glm::dot(direction, other);
            first += cosine / kCount;
            second += cosine * cosine / kCount;
            fourth += cosine * cosine * cosine * cosine / kCount;
            across += side / kCount;
            across_squared += side * side / kCount;
        }
        // Five standard errors; no power varies by more than 0.5.
        const double room = 5.0 * 0.5 / std::sqrt(static_cast<double>(kCount));
        EXPECT_NEAR(first, 2.0 / 3.0, room);
        EXPECT_NEAR(second, 0.5, room);
        EXPECT_NEAR(fourth, 1.0 / 3.0, room);
        EXPECT_NEAR(across, 0.0, room);
        EXPECT_NEAR(across_squared, 0.25, room);
    }
}

}  // namespace
}  // namespace earshot::propagation
