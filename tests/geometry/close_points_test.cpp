// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/close_points.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace earshot::geometry {
namespace {

constexpr std::uint64_t kSeed = 5;

std::vector<std::uint8_t> by_trying_all(const std::vector<Vec3>& points,
                                        const std::vector<std::uint8_t>& takes_part,
                                        double distance) {
    std::vector<std::uint8_t> marks(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (i != k && takes_part[i] != 0 && takes_part[k] != 0 &&
                glm::distance(points[i], points[k]) <= distance) {
                marks[i] = 1;
            }
        }
    }
    return marks;
}

Vec3 random_point(std::uint64_t stream, std::uint64_t i) {
    return {random_between(kSeed, stream, 3 * i, -1.0, 1.0),
            random_between(kSeed, stream, 3 * i + 1, -1.0, 1.0),
            random_between(kSeed, stream, 3 * i + 2, -1.0, 1.0)};
}

TEST(ClosePoints, AreThoseThatAnExhaustiveSearchFinds) {
    for (const double distance : {0x1p-23, 1e-3, 0.02, 0.1}) {
        std::vector<Vec3> points;
        std::vector<std::uint8_t> takes_part;
        for (std::uint64_t i = 0; i < 700; ++i) {
            const Vec3 point = random_point(1, i);
            points.push_back(point);
            // Half have a neighbour at about the distance, on either side of it.
            const double share = 0.5 + random(kSeed, 2, i);
            points.push_back(i % 2 == 0
                                 ? point + share * distance * glm::normalize(random_point(3, i))
                                 : random_point(4, i));
            takes_part.insert(takes_part.end(),
                              {i % 7 == 0 ? std::uint8_t{0} : std::uint8_t{1}, 1});
        }
        const auto expected = by_trying_all(points, takes_part, distance);
        const auto marks = mark_close_points(points, takes_part, distance);
        std::size_t more = 0, close = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            ASSERT_GE(marks[i], expected[i]) << distance << ", point " << i;
            more += marks[i] > expected[i] ? 1 : 0;
            close += expected[i];
        }
        EXPECT_GT(close, 100U);
        // Where they do not crowd.
        EXPECT_TRUE(distance > 0.01 || more == 0) << distance << ": " << more;
    }
}

TEST(ClosePoints, OfACrowdAreAllMarked) {
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; i < 5000; ++i) {
        points.push_back(Vec3(0.25) + 1e-4 * random_point(1, i));
    }
    const std::vector<std::uint8_t> all(points.size(), 1);
    const auto marks = mark_close_points(points, all, 1e-3);
    EXPECT_EQ(marks, std::vector<std::uint8_t>(points.size(), 1));
}

TEST(ClosePoints, NeighboursAcrossTheBordersOfCellsAreFound) {
    // Pairs astride planes of the grid, at 32 distances from one to the next.
    constexpr double kDistance = 0x1p-10;
    for (int axis = 0; axis < 3; ++axis) {
        for (int cell = -3; cell <= 3; ++cell) {
            Vec3 border(0.1);
            border[axis] = 32.0 * kDistance * cell;
            Vec3 below = border, above = border;
            below[axis] -= 0.49 * kDistance;
            above[axis] += 0.49 * kDistance;
            const std::vector<Vec3> points = {below, above};
            EXPECT_EQ(mark_close_points(points, std::vector<std::uint8_t>{1, 1}, kDistance),
                      (std::vector<std::uint8_t>{1, 1}));
        }
    }
}

}  // namespace
}  // namespace earshot::geometry
