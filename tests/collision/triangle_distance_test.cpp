// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/triangle_distance.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hard_triangles.h"
#include "support/meshes.h"

namespace earshot::collision {
namespace {

using geometry::Vec3;

double longest_edge(const Corners& a, const Corners& b) {
    double longest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        longest = std::max(
            {longest, glm::length(a[(i + 1) % 3] - a[i]), glm::length(b[(i + 1) % 3] - b[i])});
    }
    return longest;
}

void expect_true_distance(const Corners& a, const Corners& b) {
    const TriangleDistance found = distance(a, b);
    const auto expected = static_cast<double>(test::feature_distance(a, b));
    const double tolerance = 0x1p-44 * (expected + longest_edge(a, b));
    if (intersect(a, b)) {
        EXPECT_EQ(found.distance, 0.0);
    } else {
        EXPECT_GT(found.distance, 0.0);
        EXPECT_NEAR(found.distance, expected, tolerance);
    }
    // The points as returned are rounded to their coordinates.
    const double coordinate = std::max(glm::length(found.on_one), glm::length(found.on_other));
    EXPECT_NEAR(glm::length(found.on_one - found.on_other),
                found.distance,
                tolerance + 0x1p-50 * coordinate);
    for (const auto& [point, triangle] :
         {std::pair(found.on_one, a), std::pair(found.on_other, b)}) {
        EXPECT_LT(static_cast<double>(test::feature_distance({point, point, point}, triangle)),
                  64.0 * tolerance + 0x1p-50 * coordinate);
    }
}

TEST(TriangleDistance, IsTheLeastOverAllPairsOfFeatures) {
    for (std::uint64_t i = 0; i < 4000; ++i) {
        SCOPED_TRACE(i);
        Corners a, b;
        const Vec3 apart = (i % 4 == 0 ? 0.5 : 3.0) * test::random_point(6, i);
        for (std::size_t k = 0; k < 3; ++k) {
            a[k] = test::random_point(7, 3 * i + k);
            b[k] = test::random_point(8, 3 * i + k) + apart;
        }
        expect_true_distance(a, b);
    }
}

TEST(TriangleDistance, HoldsForHardPairsAtEveryScale) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        SCOPED_TRACE(i);
        const auto [a, b] =
            test::hard_pair(9, i).scaled(static_cast<int>(random_bits(10, 0, i) % 81) - 60);
        expect_true_distance(a, b);
    }
}

TEST(TriangleDistance, KeepsItsDigitsForEdgesThatAreNearlyParallel) {
    // Edges along x that cross at a small angle a known height apart, far from the other edges.
    for (const double angle : {1e-3, 1e-6, 1e-8, 1e-10, 1e-13}) {
        const double height = 0.1;
        const Corners a{Vec3{-1, 0, 0}, {1, 0, 0}, {0, 0, -5}};
        const Corners b{Vec3{-1, -angle, height}, {1, angle, height}, {0, 0, 5}};
        EXPECT_NEAR(distance(a, b).distance, height, 0x1p-44 * 8.0) << angle;
    }
    for (const double angle : {1e-3, 1e-6, 1e-8, 1e-10}) {
        const Corners a{Vec3{-1, 0, 0}, {1, 0, 0}, {0, 0, -5}};
        const Corners b{Vec3{-1, -angle, 1e-13}, {1, angle, 1e-13}, {0, 0, 5}};
        EXPECT_NEAR(distance(a, b).distance, 1e-13, 0x1p-44 * 8.0) << angle;
    }
}

TEST(TriangleDistance, IsPositiveHoweverNearTrianglesAreThatDoNotMeet) {
    const Corners floor{Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_GT(distance(floor, {Vec3{0.25, 0.25, 1e-60}, {0, 0, 1}, {1, 0, 1}}).distance, 0.0);
    EXPECT_EQ(distance(floor, {Vec3{0.25, 0.25, 0}, {0, 0, 1}, {1, 0, 1}}).distance, 0.0);
}

}  // namespace
}  // namespace earshot::collision
