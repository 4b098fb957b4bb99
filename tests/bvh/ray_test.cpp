// SPDX-License-Identifier: MIT
#include "earshot/bvh/ray.h"

#include "earshot/bvh/brute_force.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <cmath>
#include <limits>

namespace earshot::bvh {
namespace {

using geometry::Ray;
using geometry::Segment;
using geometry::Vec3;

Tree tree_of(const geometry::Mesh& mesh, int max_leaf_size = 4) {
    return Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = max_leaf_size});
}

/// Rays at random, at vertices, along axes and in the planes of triangles.
Ray nasty_ray(const geometry::Mesh& mesh, std::uint64_t seed, std::uint64_t i) {
    Ray ray{.origin = test::random_point(seed, 2 * i, -2.0, 2.0)};
    const auto& triangle = mesh.triangles[random_bits(seed, 5, i) % mesh.triangles.size()];
    const Vec3& a = mesh.positions[triangle[0]];
    const Vec3& b = mesh.positions[triangle[1]];
    switch (i % 5) {
        case 0:
            ray.direction = test::random_point(seed, 2 * i + 1);
            break;
        case 1:
            ray.direction = a - ray.origin;
            break;
        case 2:
            ray.direction = 0.5 * (a + b) - ray.origin;
            break;
        case 3:
            ray.origin[static_cast<int>(i % 3)] = a[static_cast<int>(i % 3)];
            ray.direction = Vec3(0.0);
            ray.direction[static_cast<int>((i + 1) % 3)] = i % 2 == 0 ? 1.0 : -1.0;
            break;
        default:
            ray.origin = a;
            ray.direction = b - a;
    }
    return ray;
}

TEST(ClosestHit, EqualsBruteForceForEveryTree) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const auto mesh = test::triangle_soup(seed, 800);
        const Tree single = tree_of(mesh, 1);
        const Tree usual = tree_of(mesh);
        auto moved = mesh;
        for (Vec3& position : moved.positions) {
            position = Vec3(position.z, -position.x, 0.5 * position.y);
        }
        Tree refitted = tree_of(moved, 15);
        refitted.refit(triangle_boxes(mesh.view()));
        int hits = 0;
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const Ray ray = nasty_ray(mesh, seed, i);
            const auto expected = brute_force::closest_hit(mesh.view(), ray);
            ASSERT_EQ(closest_hit(single, mesh.view(), ray), expected) << seed << " ray " << i;
            ASSERT_EQ(closest_hit(usual, mesh.view(), ray), expected) << seed << " ray " << i;
            ASSERT_EQ(closest_hit(refitted, mesh.view(), ray), expected) << seed << " ray " << i;
            hits += expected ? 1 : 0;
        }
        EXPECT_GT(hits, 1000);
    }
}

TEST(ClosestHit, IsThePointWhereTheRayHitsTheTriangle) {
    const auto mesh = test::sphere(4, 2.0, {1, 2, 3});
    const Tree tree = tree_of(mesh);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Ray ray{.origin = {1, 2, 3}, .direction = glm::normalize(test::random_point(9, i))};
        const auto hit = closest_hit(tree, mesh.view(), ray);
        ASSERT_TRUE(hit);
        const auto& triangle = mesh.triangles[hit->triangle];
        const Vec3 on_triangle = (1.0 - hit->u - hit->v) * mesh.positions[triangle[0]] +
                                 hit->u * mesh.positions[triangle[1]] +
                                 hit->v * mesh.positions[triangle[2]];
        EXPECT_LT(glm::distance(on_triangle, ray.origin + hit->t * ray.direction), 1e-14);
        EXPECT_NEAR(hit->t, 2.0, 0.02);
    }
}

TEST(ClosestHit, NoRayLeaksThroughEdgesOrVertices) {
    // At the origin, 25 cm across, and 10 km away.
    const std::vector<std::pair<double, Vec3>> places = {
        {1.0, Vec3(0.0)}, {0.125, {0.1, -0.05, 0.02}}, {1.0, {7000.1, -7000.2, 300.3}}};
    for (const auto& [radius, centre] : places) {
        const auto mesh = test::sphere(4, radius, centre);
        const Tree tree = tree_of(mesh);
        std::uint64_t leaks = 0;
        for (std::uint64_t i = 0; i < 60000; ++i) {
            const auto& triangle = mesh.triangles[i % mesh.triangles.size()];
            const Vec3& a = mesh.positions[triangle[i % 3]];
            const Vec3& b = mesh.positions[triangle[(i + 1) % 3]];
            const double share = i % 7 == 0 ? 0.0 : random(17, 0, i);
            const Vec3 origin = centre + 0.5 * radius * test::random_point(18, i);
            const Ray ray{.origin = origin, .direction = a + share * (b - a) - origin};
            leaks += closest_hit(tree, mesh.view(), ray) ? 0 : 1;
        }
        EXPECT_EQ(leaks, 0U) << "radius " << radius;
    }
}

TEST(ClosestHit, OfHitsAtTheSameParameterTheLowestTriangleWins) {
    auto mesh = test::triangle_soup(1, 40);
    const auto once = mesh.triangles;
    mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
    const Tree tree = tree_of(mesh, 1);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const auto hit = closest_hit(tree, mesh.view(), nasty_ray(mesh, 4, i));
        EXPECT_TRUE(!hit || hit->triangle < once.size());
    }
}

TEST(ClosestHit, InvalidRaysHitNothing) {
    const auto mesh = test::sphere(2, 1.0, Vec3(0.0));
    const Tree tree = tree_of(mesh);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double nan = std::nan("");
    const Vec3 x = {1, 0, 0};
    EXPECT_TRUE(closest_hit(tree, mesh.view(), {.direction = x}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = Vec3(0.0)}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = {nan, 0, 0}}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = {kInfinity, 0, 0}}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.origin = {0, nan, 0}, .direction = x}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.origin = {0, kInfinity, 0}, .direction = x}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = x, .t_max = nan}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = x, .t_max = -1.0}));
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = x, .t_max = 0.5}));
    // A denormal component counts as none; one beside a usual one does not disturb it.
    EXPECT_FALSE(closest_hit(tree, mesh.view(), {.direction = {5e-324, 0, 0}}));
    EXPECT_TRUE(closest_hit(tree, mesh.view(), {.direction = {1, 5e-324, -5e-324}}));
    EXPECT_FALSE(closest_hit({}, mesh.view(), {.direction = x}));
}

TEST(Occluded, EqualsBruteForce) {
    const auto mesh = test::triangle_soup(6, 800);
    const Tree tree = tree_of(mesh);
    int blocked = 0;
    for (std::uint64_t i = 0; i < 8000; ++i) {
        const Ray ray = nasty_ray(mesh, 8, i);
        const Segment segment{ray.origin, ray.origin + ray.direction};
        const bool expected = brute_force::occluded(mesh.view(), segment);
        ASSERT_EQ(occluded(tree, mesh.view(), segment), expected) << "segment " << i;
        blocked += expected ? 1 : 0;
    }
    EXPECT_GT(blocked, 2000);
    EXPECT_LT(blocked, 8000);
}

TEST(Occluded, TouchingIsBlocking) {
    const geometry::Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const Tree tree = tree_of(mesh);
    const auto blocked = [&](const Vec3& from, const Vec3& to) {
        return occluded(tree, mesh.view(), {from, to});
    };
    EXPECT_TRUE(blocked({0, 0, 1}, {0, 0, -1}));         // through a vertex
    EXPECT_TRUE(blocked({0.5, 0, 1}, {0.5, 0, -1}));     // through an edge
    EXPECT_TRUE(blocked({-1, 0, 0}, {2, 0, 0}));         // along an edge
    EXPECT_TRUE(blocked({-1, 0.25, 0}, {2, 0.25, 0}));   // in the plane
    EXPECT_TRUE(blocked({0.2, 0.2, 1}, {0.2, 0.2, 0}));  // ends on it
    EXPECT_TRUE(blocked({0.2, 0.2, 0}, {0.2, 0.2, 0}));  // a point on it
    EXPECT_FALSE(blocked({0.2, 0.2, 1}, {0.2, 0.2, 1e-300}));
    EXPECT_FALSE(blocked({-1, -1e-300, 0}, {2, -1e-300, 0}));
}

TEST(AnyHit, OffersTheCallerTheParameter) {
    const auto mesh = test::sphere(3, 1.0, Vec3(0.0));
    const Tree tree = tree_of(mesh);
    const Segment segment{{-2, 0.01, 0.02}, {2, 0.01, 0.02}};
    const auto beyond = [&](double least) {
        return any_hit(
            tree, mesh.view(), segment, [&](geometry::TriangleId, double t) { return t > least; });
    };
    EXPECT_TRUE(beyond(0.2));
    EXPECT_TRUE(beyond(0.74));
    EXPECT_FALSE(beyond(0.76));
}

}  // namespace
}  // namespace earshot::bvh
