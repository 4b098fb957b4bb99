// SPDX-License-Identifier: MIT
#include "earshot/bvh/closest_point.h"

#include "earshot/bvh/brute_force.h"

#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <cmath>

namespace earshot::bvh {
namespace {

using geometry::Vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kSeed = 11;

TEST(ClosestPoint, EqualsBruteForceForEveryTree) {
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        const auto trees = test::query_trees(of.mesh);
        for (std::uint64_t i = 0; i < 600; ++i) {
            const Vec3 point = test::query_point(of, kSeed, i);
            const double max_distance =
                i % 3 == 0 ? 0.1 * of.size * random(kSeed, 9, i) : kInfinity;
            const auto expected = brute_force::closest_point(of.mesh.view(), point, max_distance);
            for (const Tree& tree : trees) {
                ASSERT_EQ(closest_point(tree, of.mesh.view(), point, max_distance), expected)
                    << of.name << ", seed " << kSeed << ", point " << i;
            }
        }
    }
}

TEST(ClosestPoint, OfASphereLiesTowardsThePoint) {
    const Vec3 centre = {1, 2, 3};
    const auto mesh = test::sphere(5, 2.0, centre);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Vec3 point = centre + 5.0 * test::random_point(kSeed, i);
        const auto found = closest_point(tree, mesh.view(), point);
        ASSERT_TRUE(found);
        // The flat triangles lie up to 2 * (1 - cos(half an edge's angle)) inside the sphere.
        EXPECT_NEAR(found->distance, std::abs(glm::distance(point, centre) - 2.0), 2e-3) << i;
    }
}

TEST(ClosestPoint, AtASharedVertexTheLowestTriangleWins) {
    const auto mesh = test::cube(4, 0.5);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = 1});
    for (std::size_t vertex = 0; vertex < mesh.positions.size(); ++vertex) {
        const auto found = closest_point(tree, mesh.view(), mesh.positions[vertex]);
        const auto first = std::find_if(
            mesh.triangles.begin(), mesh.triangles.end(), [&](const geometry::Triangle& triangle) {
                return std::find(triangle.begin(), triangle.end(), vertex) != triangle.end();
            });
        ASSERT_TRUE(found);
        EXPECT_EQ(found->triangle, first - mesh.triangles.begin());
        EXPECT_EQ(found->distance, 0.0);
        EXPECT_EQ(found->point, mesh.positions[vertex]);
    }
}

TEST(ClosestPoint, InvalidQueriesFindNothing) {
    const auto mesh = test::cube(2, 0.5);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const double nan = std::nan("");
    EXPECT_TRUE(closest_point(tree, mesh.view(), {1, 0, 0}));
    EXPECT_TRUE(closest_point(tree, mesh.view(), {1, 0, 0}, 0.5));
    EXPECT_FALSE(closest_point(tree, mesh.view(), {1, 0, 0}, std::nextafter(0.5, 0.0)));
    EXPECT_FALSE(closest_point(tree, mesh.view(), {1, 0, 0}, nan));
    EXPECT_FALSE(closest_point(tree, mesh.view(), {1, 0, 0}, -1.0));
    EXPECT_FALSE(closest_point(tree, mesh.view(), {nan, 0, 0}));
    EXPECT_FALSE(closest_point(tree, mesh.view(), {0, kInfinity, 0}));
    EXPECT_FALSE(closest_point({}, {}, {1, 0, 0}));
}

TEST(ClosestTriangles, EqualBruteForceForEveryTree) {
    for (const test::QueryMesh& of : test::query_meshes(kSeed + 1)) {
        const auto trees = test::query_trees(of.mesh);
        for (std::uint64_t i = 0; i < 160; ++i) {
            const Vec3 point = test::query_point(of, kSeed, i);
            const double max_distance =
                i % 3 == 0 ? 0.3 * of.size * random(kSeed, 9, i) : kInfinity;
            for (const std::size_t count : {0U, 1U, 7U, 5000U}) {
                const auto expected =
                    brute_force::closest_triangles(of.mesh.view(), point, count, max_distance);
                for (const Tree& tree : trees) {
                    ASSERT_EQ(closest_triangles(tree, of.mesh.view(), point, count, max_distance),
                              expected)
                        << of.name << ", seed " << kSeed << ", point " << i << ", " << count;
                }
            }
        }
    }
}

}  // namespace
}  // namespace earshot::bvh
