// SPDX-License-Identifier: MIT
#include "earshot/bvh/brute_force.h"

#include <gtest/gtest.h>

namespace earshot::bvh {
namespace {

// Two walls across the x axis, at x = 1 and x = 2.
const geometry::Mesh kWalls{
    {{1, -1, -1}, {1, 3, -1}, {1, -1, 3}, {2, -1, -1}, {2, 3, -1}, {2, -1, 3}},
    {{3, 4, 5}, {0, 1, 2}}};

TEST(BruteForce, FindsTheNearerOfTwoWalls) {
    const auto hit = brute_force::closest_hit(kWalls.view(), {.direction = {2, 0, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->triangle, 1U);
    EXPECT_DOUBLE_EQ(hit->t, 0.5);  // in multiples of the direction
    EXPECT_DOUBLE_EQ(hit->u, 0.25);
    EXPECT_DOUBLE_EQ(hit->v, 0.25);
    EXPECT_FALSE(brute_force::closest_hit(kWalls.view(), {.direction = {-1, 0, 0}}));
    EXPECT_FALSE(brute_force::closest_hit(geometry::MeshView{}, {.direction = {1, 0, 0}}));
}

TEST(BruteForce, SegmentsStopAtTheirEnds) {
    EXPECT_TRUE(brute_force::occluded(kWalls.view(), {{0, 0, 0}, {1, 0, 0}}));
    EXPECT_FALSE(brute_force::occluded(kWalls.view(), {{0, 0, 0}, {0.99, 0, 0}}));
    EXPECT_FALSE(brute_force::occluded(kWalls.view(), {{1.01, 0, 0}, {1.99, 0, 0}}));
    EXPECT_FALSE(brute_force::occluded(geometry::MeshView{}, {{0, 0, 0}, {1, 0, 0}}));
}

}  // namespace
}  // namespace earshot::bvh
