// SPDX-License-Identifier: MIT
#include "earshot/io/internal/polygons.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace earshot::io {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

std::vector<Triangle> triangulated(const std::vector<Vec3>& polygon) {
    std::vector<VertexId> corners(polygon.size());
    std::iota(corners.begin(), corners.end(), VertexId{0});
    std::vector<Triangle> triangles;
    triangulate(polygon, corners, triangles);
    return triangles;
}

/// Areas of the triangles along the polygon's normal: all positive and summing to the polygon's if
/// nothing overlaps, sticks out or is turned over.
void expect_covers(const std::vector<Vec3>& polygon, const std::string& label) {
    Vec3 whole(0.0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        whole += glm::cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    }
    const double size = std::sqrt(glm::dot(whole, whole));
    const std::vector<Triangle> triangles = triangulated(polygon);
    EXPECT_EQ(triangles.size(), polygon.size() - 2) << label;
    double sum = 0.0;
    for (const Triangle& t : triangles) {
        const Vec3 area = glm::cross(polygon[t[1]] - polygon[t[0]], polygon[t[2]] - polygon[t[0]]);
        EXPECT_GE(glm::dot(area, whole), 0.0) << label;
        sum += glm::dot(area, whole) / size;
    }
    EXPECT_NEAR(sum, size, 1e-12 * size) << label;
}

TEST(Polygons, TriangleStaysAsItIs) {
    EXPECT_EQ(triangulated({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_TRUE(triangulated({{0, 0, 0}, {1, 0, 0}}).empty());
}

TEST(Polygons, ArrowIsCutAtItsNotch) {
    // A fan from corner 0 would cover ground outside the arrow.
    const std::vector<Vec3> arrow{{0, 2, 0}, {-1, -1, 0}, {0, 0, 0}, {1, -1, 0}};
    expect_covers(arrow, "arrow");
    const std::vector<Vec3> turned{arrow[1], arrow[2], arrow[3], arrow[0]};
    expect_covers(turned, "turned arrow");
}

TEST(Polygons, CornersOnStraightEdgesAndKeyholes) {
    expect_covers({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}, "straight");
    // A square with a square hole, joined by a seam: corners 4 and 9, 3 and 10 coincide.
    expect_covers({{0, 0, 0},
                   {4, 0, 0},
                   {4, 4, 0},
                   {0, 4, 0},
                   {0, 0, 0},
                   {1, 1, 0},
                   {1, 3, 0},
                   {3, 3, 0},
                   {3, 1, 0},
                   {1, 1, 0}},
                  "keyhole");
}

TEST(Polygons, StarsInAnyPlaneAreCovered) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto count = 4 + random_bits(seed, 0, 0) % 60;
        const Vec3 u = glm::normalize(Vec3(random_between(seed, 1, 0, -1.0, 1.0),
                                           random_between(seed, 1, 1, -1.0, 1.0),
                                           random_between(seed, 1, 2, -1.0, 1.0)));
        const Vec3 v = glm::normalize(glm::cross(u, Vec3(0.3, -0.5, 0.8)));
        std::vector<Vec3> star;
        for (std::uint64_t i = 0; i < count; ++i) {
            const double angle =
                2.0 * math::kPi * static_cast<double>(i) / static_cast<double>(count);
            const double radius = random_between(seed, 2, i, 0.2, 3.0);
            star.push_back(Vec3(1.0, 2.0, 3.0) +
                           radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
        expect_covers(star, "seed " + std::to_string(seed));
    }
}

TEST(Polygons, PolygonsThatCrossThemselvesStillEnd) {
    EXPECT_EQ(triangulated({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2U);
    EXPECT_EQ(triangulated(std::vector<Vec3>(7, Vec3(1.0))).size(), 5U);
}

}  // namespace
}  // namespace earshot::io
