// SPDX-License-Identifier: MIT
#include "earshot/geometry/overlap.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace earshot::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Contact and degeneracy are frequent on a small grid.
Vec3 grid_point(std::uint64_t seed, std::uint64_t i) {
    const auto coordinate = [&](std::uint64_t k) {
        return static_cast<double>(random_bits(seed, k, i) % 4);
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
}

Corners grid_triangle(std::uint64_t seed, std::uint64_t i) {
    return {grid_point(seed, 3 * i), grid_point(seed, 3 * i + 1), grid_point(seed, 3 * i + 2)};
}

Corners random_triangle(std::uint64_t seed, std::uint64_t i) {
    return {test::random_point(seed, 3 * i),
            test::random_point(seed, 3 * i + 1),
            test::random_point(seed, 3 * i + 2)};
}

bool touch(const auto& region, const Corners& t) {
    return region.touches(t[0], t[1], t[2]);
}

TriangleRegion region_of(const Corners& t) {
    return {t[0], t[1], t[2]};
}

bool parts(const Vec3& axis, const Corners& one, const Corners& other) {
    const auto [low, high] = std::minmax({dot(axis, one[0]), dot(axis, one[1]), dot(axis, one[2])});
    const auto [least, most] =
        std::minmax({dot(axis, other[0]), dot(axis, other[1]), dot(axis, other[2])});
    return high < least || most < low;
}

/// Whether an axis parts two triangles, segments or points with small whole coordinates, which
/// makes all numbers here exact. Tries more axes than enough: edges, lines between corners, normals
/// of any two of these, and what is normal to a normal and an edge.
bool an_axis_parts(const Corners& one, const Corners& other) {
    std::vector<Vec3> lines;
    for (std::size_t i = 0; i < 3; ++i) {
        lines.push_back(one[(i + 1) % 3] - one[i]);
        lines.push_back(other[(i + 1) % 3] - other[i]);
    }
    for (const Vec3& a : one) {
        for (const Vec3& b : other) {
            lines.push_back(b - a);
        }
    }
    for (const Vec3& line : lines) {
        if (parts(line, one, other)) {
            return true;
        }
        for (const Vec3& second : lines) {
            const Vec3 normal = glm::cross(line, second);
            if (parts(normal, one, other)) {
                return true;
            }
            for (std::size_t edge = 0; edge < 6; ++edge) {
                if (parts(glm::cross(normal, lines[edge]), one, other)) {
                    return true;
                }
            }
        }
    }
    return false;
}

TEST(TriangleRegion, TouchesWhatNoAxisParts) {
    int touching = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const Corners one = grid_triangle(1, i);
        const Corners other = grid_triangle(2, i);
        const bool expected = !an_axis_parts(one, other);
        ASSERT_EQ(touch(region_of(one), other), expected) << i;
        ASSERT_EQ(touch(region_of(other), {one[2], one[1], one[0]}), expected) << i;
        touching += expected ? 1 : 0;
    }
    EXPECT_GT(touching, 500);
    EXPECT_LT(touching, 2500);
}

TEST(TriangleRegion, ContactIsDecidedToTheLastBit) {
    const TriangleRegion region({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_TRUE(region.touches({0.25, 0.25, 0}, {0, 0, 1}, {1, 0, 1}));
    EXPECT_FALSE(region.touches({0.25, 0.25, 1e-80}, {0, 0, 1}, {1, 0, 1}));
    EXPECT_TRUE(region.touches({0.5, 0.5, 0}, {1, 1, 0}, {2, 1, 0}));  // in its plane
    EXPECT_FALSE(region.touches({0.5, std::nextafter(0.5, 1.0), 0}, {1, 1, 0}, {2, 1, 0}));
    EXPECT_TRUE(region.touches({0.1, 0.1, 0}, {0.2, 0.1, 0}, {0.1, 0.2, 0}));  // inside it
    EXPECT_TRUE(region.touches({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}));           // around it
    EXPECT_FALSE(TriangleRegion({0, 0, std::nan("")}, {1, 0, 0}, {0, 1, 0})
                     .touches({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
}

/// The surface of a box, as triangles.
std::vector<Corners> surface(const Vec3& lower, const Vec3& upper) {
    const auto mesh = test::cube(1, 0.5);
    std::vector<Corners> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        Corners& t = triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            t[k] = lower + (mesh.positions[triangle[k]] + 0.5) * (upper - lower);
        }
    }
    return triangles;
}

// What touches a box touches its surface or lies within it.
bool touches_surface_or_inside(const Vec3& lower, const Vec3& upper, const Corners& t) {
    const auto walls = surface(lower, upper);
    return glm::clamp(t[0], lower, upper) == t[0] ||
           std::any_of(walls.begin(), walls.end(), [&](const Corners& wall) {
               return touch(region_of(wall), t);
           });
}

TEST(BoxRegion, TouchesWhatTouchesItsSurfaceOrLiesWithin) {
    int touching = 0;
    for (std::uint64_t i = 0; i < 12000; ++i) {
        const bool is_on_grid = i % 2 == 0;
        const Vec3 p = is_on_grid ? grid_point(3, i) : test::random_point(3, i);
        const Vec3 q = is_on_grid ? grid_point(4, i) : test::random_point(4, i);
        const Corners t = is_on_grid ? grid_triangle(5, i) : random_triangle(5, i);
        const Vec3 lower = glm::min(p, q);
        const Vec3 upper = glm::max(p, q);
        const bool expected = touches_surface_or_inside(lower, upper, t);
        ASSERT_EQ(touch(BoxRegion(lower, upper), t), expected) << i;
        touching += expected ? 1 : 0;
    }
    EXPECT_GT(touching, 3000);
    EXPECT_LT(touching, 9000);
}

TEST(BoxRegion, MayBeUnboundedOrEmpty) {
    const Corners t{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    EXPECT_TRUE(touch(BoxRegion(Vec3(-kInfinity), Vec3(kInfinity)), t));
    EXPECT_TRUE(touch(BoxRegion({0.5, 0.5, -kInfinity}, Vec3(kInfinity)), t));
    EXPECT_FALSE(touch(BoxRegion({0.5, 0.6, -kInfinity}, Vec3(kInfinity)), t));
    EXPECT_FALSE(touch(BoxRegion(Vec3(1.0), Vec3(0.0)), t));
    EXPECT_FALSE(touch(BoxRegion(Vec3(-1.0), {1.0, std::nan(""), 1.0}), t));
    EXPECT_FALSE(touch(BoxRegion({std::nan(""), -1.0, -1.0}, Vec3(1.0)), t));
}

TEST(SphereRegion, TouchesFromItsRadiusOn) {
    const Corners t{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
    EXPECT_TRUE(touch(SphereRegion({1, 1, 3}, 3.0), t));
    EXPECT_FALSE(touch(SphereRegion({1, 1, 3}, std::nextafter(3.0, 0.0)), t));
    EXPECT_TRUE(touch(SphereRegion({-3, -4, 0}, 5.0), t));
    EXPECT_TRUE(touch(SphereRegion({4, 0, 0}, 0.0), t));
    EXPECT_FALSE(touch(SphereRegion({1, 1, 0}, -1.0), t));
    EXPECT_FALSE(touch(SphereRegion({1, 1, 0}, std::nan("")), t));
    EXPECT_FALSE(touch(SphereRegion({1, kInfinity, 0}, kInfinity), t));
}

std::vector<Plane> planes_of_box(const Vec3& lower, const Vec3& upper) {
    return {{{-1, 0, 0}, -lower.x},
            {{0, -1, 0}, -lower.y},
            {{0, 0, -1}, -lower.z},
            {{1, 0, 0}, upper.x},
            {{0, 1, 0}, upper.y},
            {{0, 0, 1}, upper.z}};
}

TEST(ConvexRegion, OfSixPlanesIsTheBox) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3 p = test::random_point(6, i);
        const Vec3 q = test::random_point(7, i);
        const Corners t = random_triangle(8, i);
        const Vec3 lower = glm::min(p, q);
        const Vec3 upper = glm::max(p, q);
        ASSERT_EQ(touch(ConvexRegion(planes_of_box(lower, upper)), t),
                  touch(BoxRegion(lower, upper), t))
            << i;
    }
}

TEST(ConvexRegion, OfAPyramidTakesWhatItSees) {
    // Apex at the origin, looking along +x, 45 degrees to each side.
    const std::vector<Plane> planes = {
        {{-1, 1, 0}, 0.0}, {{-1, -1, 0}, 0.0}, {{-1, 0, 1}, 0.0}, {{-1, 0, -1}, 0.0}};
    const ConvexRegion pyramid(planes);
    EXPECT_TRUE(pyramid.touches({2, 0, 0}, {3, 0, 0}, {3, 1, 0}));
    EXPECT_TRUE(pyramid.touches({2, 2, 0}, {2, 3, 0}, {2, 3, 1}));     // on its border
    EXPECT_TRUE(pyramid.touches({0, 0, 0}, {-1, 0, 0}, {-1, 1, 0}));   // at its apex
    EXPECT_TRUE(pyramid.touches({1, -9, -9}, {1, 9, -9}, {1, 0, 9}));  // around it
    EXPECT_FALSE(pyramid.touches({-1, -9, -9}, {-1, 9, -9}, {-1, 0, 9}));
    // Behind no single plane's front, yet beside it.
    EXPECT_FALSE(pyramid.touches({1, 3, 0}, {-2, -1, 0}, {-2, 5, 0}));
    EXPECT_TRUE(ConvexRegion({}).touches({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
}

TEST(ConvexRegion, NeedsFinitePlanesAndNotTooMany) {
    const std::vector<Plane> unknown = {{{1, 0, std::nan("")}, 0.0}};
    EXPECT_FALSE(ConvexRegion(unknown).touches({-1, 0, 0}, {-2, 0, 0}, {-1, 1, 0}));
    const std::vector<Plane> few(ConvexRegion::kMaxPlanes, Plane{{1, 0, 0}, 0.0});
    EXPECT_TRUE(ConvexRegion(few).touches({-1, 0, 0}, {1, 0, 0}, {1, 1, 0}));
    const std::vector<Plane> many(ConvexRegion::kMaxPlanes + 1);
    EXPECT_THROW(ConvexRegion{many}, Error);
}

// Cutting a triangle by planes around it yields a polygon with a corner more per plane.
TEST(ConvexRegion, CutsByAllItsPlanes) {
    std::vector<Plane> planes;
    constexpr double kTurn = 6.283185307179586;
    for (std::size_t i = 0; i < ConvexRegion::kMaxPlanes; ++i) {
        const double angle = kTurn * static_cast<double>(i) / ConvexRegion::kMaxPlanes;
        planes.push_back({{std::cos(angle), std::sin(angle), 0.0}, 1.0});
    }
    const ConvexRegion disc(planes);
    EXPECT_TRUE(disc.touches({-9, -9, 0}, {9, -9, 0}, {0, 9, 0}));
    EXPECT_TRUE(disc.touches({0.9, 0.3, 0}, {9, 0.3, 0}, {9, 9, 0}));
    EXPECT_FALSE(disc.touches({1.5, 0.0, 0}, {0.0, 1.5, 0}, {9, 9, 0}));
    EXPECT_TRUE(disc.touches({1.4, 0.0, 0}, {0.0, 1.4, 0}, {9, 9, 0}));
}

}  // namespace
}  // namespace earshot::geometry
