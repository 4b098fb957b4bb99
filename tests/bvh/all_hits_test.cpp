// SPDX-License-Identifier: MIT
#include "earshot/bvh/all_hits.h"

#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/ray.h"

#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <cmath>

namespace earshot::bvh {
namespace {

using geometry::Hit;
using geometry::Ray;

constexpr std::uint64_t kSeed = 21;

std::vector<Hit> visited(const Tree& tree,
                         const geometry::MeshView& mesh,
                         const Ray& ray,
                         std::size_t max_count) {
    std::vector<Hit> hits;
    visit_hits(tree, mesh, ray, [&](const Hit& hit) {
        hits.push_back(hit);
        return hits.size() < max_count;
    });
    return hits;
}

TEST(AllHits, EqualBruteForceForEveryTree) {
    std::size_t count = 0;
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        const auto trees = test::query_trees(of.mesh);
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const Ray ray = test::query_ray(of, kSeed, i);
            const auto expected = brute_force::all_hits(of.mesh.view(), ray);
            count += expected.size();
            for (const Tree& tree : trees) {
                ASSERT_EQ(all_hits(tree, of.mesh.view(), ray), expected)
                    << of.name << ", seed " << kSeed << ", ray " << i;
                ASSERT_EQ(visited(tree, of.mesh.view(), ray, 1000000), expected)
                    << of.name << ", seed " << kSeed << ", ray " << i;
            }
        }
    }
    EXPECT_GT(count, 10000U);
}

TEST(AllHits, BeginWithTheClosest) {
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        const Tree tree = Tree::build(triangle_boxes(of.mesh.view()));
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const Ray ray = test::query_ray(of, kSeed, i);
            EXPECT_EQ(OrderedHits(tree, of.mesh.view(), ray).next(),
                      closest_hit(tree, of.mesh.view(), ray));
        }
    }
}

TEST(AllHits, EndWhereTheCallerStops) {
    const auto mesh = test::triangle_soup(kSeed, 9000);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const Ray ray{{-3, 0.1, 0.05}, {1, 0, 0}};
    const auto all = all_hits(tree, mesh.view(), ray);
    ASSERT_GT(all.size(), 5U);
    for (std::size_t max_count = 1; max_count <= all.size(); ++max_count) {
        EXPECT_EQ(
            visited(tree, mesh.view(), ray, max_count),
            std::vector<Hit>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(max_count)));
    }
}

TEST(AllHits, AClosedSurfaceIsHitTwice) {
    const auto mesh = test::sphere(3, 1.0, {0.1, 0.2, 0.3});
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const geometry::Vec3 within = {0.1, 0.2, 0.3};
        const geometry::Vec3 along = glm::normalize(test::random_point(kSeed, i));
        EXPECT_EQ(all_hits(tree, mesh.view(), {within - 3.0 * along, along}).size(), 2U) << i;
    }
}

TEST(AllHits, InvalidRaysHaveNone) {
    const auto mesh = test::cube(2, 0.5);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const double nan = std::nan("");
    EXPECT_EQ(all_hits(tree, mesh.view(), {{0, 0.1, 0.2}, {1, 0, 0}}).size(), 1U);
    for (const Ray& ray : {Ray{{nan, 0, 0}, {1, 0, 0}},
                           Ray{{0, 0, 0}, {nan, 0, 0}},
                           Ray{{0, 0, 0}, {0, 0, 0}},
                           Ray{{0, 0, 0}, {1, 0, 0}, nan}}) {
        EXPECT_TRUE(all_hits(tree, mesh.view(), ray).empty());
        EXPECT_FALSE(OrderedHits(tree, mesh.view(), ray).next());
    }
}

}  // namespace
}  // namespace earshot::bvh
