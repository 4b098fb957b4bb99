// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/border_sampling.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace earshot::visibility {
namespace {

using geometry::Vec3;

constexpr std::uint64_t kSeed = 21;
constexpr double kAngle = 1e-6;

/// How far a point is from a triangle's outline, seen from the eye, radians if it is little: in the
/// picture on a plane across the view of the point. Negative inside; empty where a corner is not
/// before that plane.
std::optional<double> outside(const Vec3& eye, const Corners& triangle, const Vec3& point) {
    const Vec3 view = glm::normalize(point - eye);
    const Vec3 other = std::abs(view.x) < 0.5 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 right = glm::normalize(glm::cross(view, other));
    const Vec3 up = glm::cross(view, right);
    std::array<glm::dvec2, 3> picture;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 to = triangle[i] - eye;
        const double ahead = glm::dot(view, to);
        if (ahead < 0.1 * glm::length(to)) {
            return std::nullopt;
        }
        picture[i] = {glm::dot(right, to) / ahead, glm::dot(up, to) / ahead};
    }
    double nearest = 10.0;
    int lefts = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 a = picture[i];
        const glm::dvec2 side = picture[(i + 1) % 3] - a;
        const double along = std::clamp(-glm::dot(a, side) / glm::dot(side, side), 0.0, 1.0);
        nearest = std::min(nearest, glm::length(a + along * side));
        lefts += side.x * -a.y - side.y * -a.x > 0.0 ? 1 : 0;
    }
    return lefts == 0 || lefts == 3 ? -nearest : nearest;
}

TEST(BorderSampling, VerticesLieJustOutsideOfTheTriangle) {
    std::size_t seen = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3 eye = test::random_point(kSeed, 4 * i);
        Corners triangle = {test::random_point(kSeed, 4 * i + 1),
                            test::random_point(kSeed, 4 * i + 2),
                            test::random_point(kSeed, 4 * i + 3)};
        if (i % 3 == 0) {  // a sliver
            triangle[2] = triangle[0] + 0.4 * (triangle[1] - triangle[0]) + 1e-3 * triangle[2];
        }
        const auto points = enlarged_polygon(eye, triangle, kAngle);
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (const auto distance = outside(eye, triangle, points[k])) {
                ASSERT_GE(*distance, 0.5 * kAngle) << "triangle " << i << ", point " << k;
                ASSERT_LE(*distance, 1.1 * kAngle) << "triangle " << i << ", point " << k;
                ++seen;
            }
        }
    }
    EXPECT_GT(seen, 90'000U);
}

TEST(BorderSampling, ReverseRaysPassTheOccluderTowardsTheHiddenPoint) {
    // A screen from x = -1 to 0 at z = -5 hides what lies at z = -10 from the eye; the region
    // reaches to x = 2.
    const ViewRegion region = {{-2.0, -2.0, 0.0}, {2.0, 2.0, 0.0}};
    const Vec3 eye(0.5, 0.0, 0.0);
    const Corners blocker = {Vec3(-1.0, -3.0, -5.0), Vec3(-1.0, 3.0, -5.0), Vec3(0.2, 0.0, -5.0)};
    const Corners wall = {Vec3(-9.0, -9.0, -10.0), Vec3(9.0, -9.0, -10.0), Vec3(0.0, 9.0, -10.0)};
    const Vec3 old_hit(3.0, 0.0, -10.0);
    const geometry::Ray ray = {eye, Vec3(0.0, 0.0, -5.0) - eye};
    const auto expected = expected_hit(ray, wall, 100.0);
    ASSERT_TRUE(expected);
    EXPECT_NEAR(glm::distance(*expected, Vec3(-0.5, 0.0, -10.0)), 0.0, 1e-12);
    const auto past =
        reverse_ray({ray, {0.0, 0.0, -5.0}, blocker, old_hit, *expected}, region, 1e-6);
    ASSERT_TRUE(past);
    EXPECT_TRUE(region.contains(past->origin));
    // At z = -5 it passes the blocker's tip at 0.2, and it ends where the ray was expected.
    const Vec3 at_screen = past->origin + (-5.0 / past->direction.z) * past->direction;
    EXPECT_NEAR(at_screen.x, 0.2 + 1e-6, 1e-9);
    const Vec3 at_wall = past->origin + (-10.0 / past->direction.z) * past->direction;
    EXPECT_NEAR(glm::distance(at_wall, *expected), 0.0, 1e-9);
}

TEST(BorderSampling, NoReverseRayWhereTheRegionDoesNotReach) {
    const ViewRegion region = {{0.4, -0.1, 0.0}, {0.6, 0.1, 0.0}};
    const Vec3 eye(0.5, 0.0, 0.0);
    const Corners blocker = {Vec3(-1.0, -3.0, -5.0), Vec3(-1.0, 3.0, -5.0), Vec3(0.2, 0.0, -5.0)};
    const geometry::Ray ray = {eye, Vec3(0.0, 0.0, -5.0) - eye};
    EXPECT_FALSE(reverse_ray(
        {ray, {0.0, 0.0, -5.0}, blocker, {3.0, 0.0, -10.0}, {-0.5, 0.0, -10.0}}, region, 1e-6));
}

TEST(BorderSampling, PlanesBehindOrParallelToARayHaveNoHit) {
    const Corners floor = {Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0)};
    EXPECT_FALSE(expected_hit({{0.0, 1.0, 0.0}, {0.0, 1.0, 0.0}}, floor, 100.0));
    EXPECT_FALSE(expected_hit({{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}}, floor, 100.0));
    EXPECT_FALSE(expected_hit({{0.0, 1.0, 0.0}, {1.0, -1e-3, 0.0}}, floor, 100.0));
    EXPECT_TRUE(expected_hit({{0.0, 1.0, 0.0}, {1.0, -1.0, 0.0}}, floor, 100.0));
}

}  // namespace
}  // namespace earshot::visibility
