// SPDX-License-Identifier: MIT
#include "earshot/bvh/batch.h"

#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/ray.h"

#include <gtest/gtest.h>

#include "support/query_meshes.h"

namespace earshot::bvh {
namespace {

constexpr std::uint64_t kSeed = 31;
constexpr std::size_t kCount = 1500;  // not a multiple of a chunk

TEST(Batch, AnswersInTheOrderOfTheQuestionsForAnyExecutor) {
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        const Tree tree = Tree::build(triangle_boxes(of.mesh.view()));
        std::vector<geometry::Ray> rays;
        std::vector<geometry::Segment> segments;
        std::vector<geometry::Vec3> points;
        for (std::size_t i = 0; i < kCount; ++i) {
            rays.push_back(test::query_ray(of, kSeed, i));
            segments.push_back({rays[i].origin, rays[i].origin + rays[i].direction});
            points.push_back(test::query_point(of, kSeed, i));
        }
        const double most = 0.2 * of.size;
        for (const int threads : {1, 2, 8}) {
            Executor executor(threads);
            const auto hits = closest_hits(tree, of.mesh.view(), rays, executor);
            const auto blocked = occluded(tree, of.mesh.view(), segments, executor);
            const auto near = closest_points(tree, of.mesh.view(), points, most, executor);
            ASSERT_EQ(hits.size(), kCount);
            ASSERT_EQ(blocked.size(), kCount);
            ASSERT_EQ(near.size(), kCount);
            for (std::size_t i = 0; i < kCount; ++i) {
                ASSERT_EQ(hits[i], closest_hit(tree, of.mesh.view(), rays[i])) << of.name << i;
                ASSERT_EQ(blocked[i] != 0, occluded(tree, of.mesh.view(), segments[i]));
                ASSERT_EQ(near[i], closest_point(tree, of.mesh.view(), points[i], most));
            }
        }
    }
}

TEST(Batch, WithoutQuestionsThereAreNoAnswers) {
    const auto mesh = test::cube(2, 0.5);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    EXPECT_TRUE(closest_hits(tree, mesh.view(), {}).empty());
    EXPECT_TRUE(occluded(tree, mesh.view(), std::span<const geometry::Segment>{}).empty());
    EXPECT_TRUE(closest_points(tree, mesh.view(), {}).empty());
}

}  // namespace
}  // namespace earshot::bvh
