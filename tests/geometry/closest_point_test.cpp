// SPDX-License-Identifier: MIT
#include "earshot/geometry/closest_point.h"

#include "earshot/geometry/intersect.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ClosestPoint nearest(const Vec3& point, const Corners& t) {
    return PreparedPoint(point).closest_point(t[0], t[1], t[2], kInfinity).value();
}

/// Fat triangles, needles, segments and points.
Corners random_triangle(std::uint64_t seed, std::uint64_t i) {
    Corners t{test::random_point(seed, 4 * i),
              test::random_point(seed, 4 * i + 1),
              test::random_point(seed, 4 * i + 2)};
    switch (i % 6) {
        case 0:
            t[2] = t[0] + 1e-9 * t[2];
            break;
        case 1:
            t[2] = t[0] + 0.25 * (t[1] - t[0]) + 1e-12 * t[2];
            break;
        case 2:
            t[1] = t[2];
            break;
        case 3:
            t[1] = t[2] = t[0];
            break;
        default:
            break;
    }
    return t;
}

// A point of a convex set is the nearest one if and only if no other point of the set lies in its
// direction: the products below are at most 0 for the corners, and hence for all their mixtures.
TEST(NearestOfTriangle, NoCornerLiesTowardsThePoint) {
    for (std::uint64_t i = 0; i < 60000; ++i) {
        const Corners t = random_triangle(3, i);
        const Vec3 point = 2.0 * test::random_point(3, 4 * i + 3);
        const ClosestPoint found = nearest(point, t);
        const double area = glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
        const bool is_fat = area > 1e-3 || area == 0.0;
        for (const Vec3& corner : t) {
            // Along a needle the foot of a perpendicular is known less well.
            ASSERT_LE(glm::dot(point - found.point, corner - found.point), is_fat ? 1e-12 : 1e-5)
                << i;
        }
        const Vec3 mixture =
            found.weights.x * t[0] + found.weights.y * t[1] + found.weights.z * t[2];
        ASSERT_LE(glm::distance(mixture, found.point), 1e-15) << i;
        ASSERT_GE(std::min({found.weights.x, found.weights.y, found.weights.z}), 0.0) << i;
        ASSERT_NEAR(found.weights.x + found.weights.y + found.weights.z, 1.0, 1e-15) << i;
        ASSERT_NEAR(found.distance, glm::distance(point, found.point), 2e-15) << i;
    }
}

TEST(NearestOfTriangle, OfANeedleIsAsNearAsItsLongEdge) {
    for (const double width : {1e-4, 1e-7, 1e-10, 1e-13}) {
        for (std::uint64_t i = 0; i < 4000; ++i) {
            // Along the x axis, with the point at a height like the width or far more.
            const double middle = random_between(4, 0, i, -1.0, 1.0);
            const Corners t{Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(middle, width, 0)};
            const double x = random_between(4, 1, i, -1.0, 1.0);
            const double top =
                width * (x < middle ? (x + 1) / (middle + 1) : (1 - x) / (1 - middle));
            const double height = i % 2 == 0 ? width : 1.0;
            const double turn = random_between(4, 2, i, 0.0, 1.0);
            const Vec3 point(x, turn * top, height);  // above the triangle
            const ClosestPoint found = nearest(point, t);
            ASSERT_NEAR(found.distance, height, 2e-14) << width << ", " << i;
            ASSERT_NEAR(found.point.x, x, 1e-14 / width) << width << ", " << i;
        }
    }
}

TEST(NearestOfTriangle, NamesTheFeatureByExactZeros) {
    const Corners t{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
    EXPECT_EQ(nearest({-1, -2, 3}, t).weights, Vec3(1, 0, 0));
    EXPECT_EQ(nearest({6, -1, 0}, t).weights, Vec3(0, 1, 0));
    EXPECT_EQ(nearest({-1, 9, 0}, t).weights, Vec3(0, 0, 1));
    EXPECT_EQ(nearest({1, -5, 1}, t).weights, Vec3(0.75, 0.25, 0));
    EXPECT_EQ(nearest({-5, 3, 1}, t).weights, Vec3(0.25, 0, 0.75));
    EXPECT_EQ(nearest({4, 4, -2}, t).weights, Vec3(0, 0.5, 0.5));
    EXPECT_EQ(nearest({1, 1, 7}, t), (ClosestPoint{0, 7.0, {1, 1, 0}, {0.5, 0.25, 0.25}}));
    EXPECT_EQ(nearest({1, 1, 0}, t).distance, 0.0);
}

TEST(NearestOfTriangle, NeighboursReportOnePointOfTheirEdge) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3 a = test::random_point(5, 5 * i);
        const Vec3 b = test::random_point(5, 5 * i + 1);
        const ClosestPoint one =
            nearest(Vec3(9.0), {a, b, a - Vec3(test::random_point(5, 5 * i, 5, 6))});
        const ClosestPoint other = nearest(Vec3(9.0), {b, test::random_point(5, 5 * i, -6, -5), a});
        ASSERT_EQ(one.weights.z, 0.0);
        ASSERT_EQ(one.point, other.point) << i;
        ASSERT_EQ(one.distance, other.distance) << i;
    }
}

TEST(NearestOfTriangle, TheBoundIsInclusive) {
    const Corners t{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
    const PreparedPoint point({1, 1, 3});
    EXPECT_TRUE(point.closest_point(t[0], t[1], t[2], 3.0));
    EXPECT_FALSE(point.closest_point(t[0], t[1], t[2], std::nextafter(3.0, 0.0)));
    EXPECT_FALSE(point.closest_point(t[0], t[1], t[2], std::nan("")));
}

TEST(PreparedPoint, NoTriangleIsNearerThanABoxAroundIt) {
    for (std::uint64_t i = 0; i < 60000; ++i) {
        const double scale = std::array{1e-12, 1.0, 1e7}[i % 3];
        Corners t = random_triangle(7, i);
        for (Vec3& corner : t) {
            corner = scale * corner + Vec3(100.0, -3.0, 5e3);
        }
        Aabb box = triangle_box(t[0], t[1], t[2]);
        const PreparedPoint point(Vec3(100.0, -3.0, 5e3) +
                                  2.0 * scale * test::random_point(7, 4 * i + 3));
        const double distance = point.closest_point(t[0], t[1], t[2], kInfinity)->distance;
        const double bound = PreparedPoint::squared_bound(distance);
        ASSERT_LE(point.squared_distance(box), bound) << i;
        box.include(Vec3(100.0) + scale * test::random_point(8, i));
        ASSERT_LE(point.squared_distance(box), bound) << i;
    }
    EXPECT_EQ(PreparedPoint(Vec3(0.0)).squared_distance(Aabb::empty()), kInfinity);
}

TEST(PreparedPoint, TheSquaredBoundIsTightAndKeepsItsMeaning) {
    for (const double most : {1e-140, 1e-9, 1.0, 1e9, 1e150}) {
        EXPECT_GT(PreparedPoint::squared_bound(most), most * most);
        EXPECT_LT(PreparedPoint::squared_bound(most), most * most * (1.0 + 1e-11));
    }
    EXPECT_GT(PreparedPoint::squared_bound(1e-200), 0.0);
    EXPECT_GT(PreparedPoint::squared_bound(0.0), 0.0);
    EXPECT_LT(PreparedPoint::squared_bound(-1.0), 0.0);
    EXPECT_EQ(PreparedPoint::squared_bound(kInfinity), kInfinity);
    EXPECT_TRUE(std::isnan(PreparedPoint::squared_bound(std::nan(""))));
}

}  // namespace
}  // namespace earshot::geometry
