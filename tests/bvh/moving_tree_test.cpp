// SPDX-License-Identifier: MIT
#include "earshot/bvh/moving_tree.h"

#include "earshot/bvh/aging.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/wide_ray.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Vec3;

/// Triangles that fly apart, each its own way.
Mesh exploded(const Mesh& mesh, double time) {
    Mesh moved = mesh;
    for (std::size_t i = 0; i < moved.triangles.size(); ++i) {
        const Vec3 velocity = test::random_point(77, i);
        for (const geometry::VertexId vertex : moved.triangles[i]) {
            moved.positions[vertex] += time * velocity;
        }
    }
    return moved;
}

std::vector<UpdateReport> follow(const Mesh& mesh, const UpdateOptions& options, int threads) {
    Executor executor(threads);
    MovingTree moving(mesh.view(), options, executor);
    std::vector<UpdateReport> reports;
    for (int frame = 1; frame <= 20; ++frame) {
        reports.push_back(moving.update(exploded(mesh, 0.05 * frame).view(), executor));
    }
    return reports;
}

std::size_t count_of(const std::vector<UpdateReport>& reports, UpdateAction action) {
    return static_cast<std::size_t>(
        std::count_if(reports.begin(), reports.end(), [&](const UpdateReport& report) {
            return report.action == action;
        }));
}

TEST(MovingTree, AnswersAsBruteForceWhateverItDoes) {
    const Mesh mesh = test::triangle_soup(1, 600);
    for (const double rays : {0.0, 2e3, 1e5, 1e9}) {
        MovingTree moving(mesh.view(), {.rays_per_update = rays});
        for (int frame = 1; frame <= 12; ++frame) {
            const Mesh now = exploded(mesh, 0.1 * frame);
            moving.update(now.view());
            for (std::uint64_t i = 0; i < 40; ++i) {
                const Ray ray = {2.0 * test::random_point(2, i), test::random_point(3, i)};
                ASSERT_EQ(closest_hit(moving.tree(), now.view(), ray),
                          brute_force::closest_hit(now.view(), ray))
                    << "rays " << rays << ", frame " << frame << ", ray " << i;
            }
        }
    }
}

TEST(MovingTree, MendsTheMoreTheMoreRaysAreAsked) {
    const Mesh mesh = test::triangle_soup(4, 3000);
    const auto none = follow(mesh, {.rays_per_update = 0.0}, 1);
    EXPECT_EQ(count_of(none, UpdateAction::refit), none.size());
    const auto some = follow(mesh, {.rays_per_update = 3e3}, 1);
    const auto many = follow(mesh, {.rays_per_update = 1e6}, 1);
    EXPECT_GT(count_of(some, UpdateAction::repair) + count_of(some, UpdateAction::rebuild), 0U);
    EXPECT_GT(count_of(many, UpdateAction::rebuild), count_of(some, UpdateAction::rebuild));
    EXPECT_LT(many.back().steps, 0.8 * none.back().steps);
}

TEST(MovingTree, DecidesTheSameForAnyNumberOfThreads) {
    const Mesh mesh = test::triangle_soup(5, 3000);
    const auto serial = follow(mesh, {.rays_per_update = 2e4}, 1);
    const auto parallel = follow(mesh, {.rays_per_update = 2e4}, 8);
    for (std::size_t i = 0; i < serial.size(); ++i) {
        EXPECT_EQ(serial[i].action, parallel[i].action) << i;
        EXPECT_EQ(serial[i].steps, parallel[i].steps) << i;
    }
}

TEST(MovingTree, LeavesARestingMeshAlone) {
    const Mesh mesh = test::triangle_soup(6, 500);
    MovingTree moving(mesh.view(), {.rays_per_update = 1e9});
    const std::uint64_t version = moving.version();
    for (int frame = 0; frame < 5; ++frame) {
        EXPECT_EQ(moving.update(mesh.view()).action, UpdateAction::refit);
    }
    EXPECT_EQ(moving.version(), version);
}

TEST(MovingTree, HoldsAnEmptyMesh) {
    const Mesh mesh;
    MovingTree moving(mesh.view());
    EXPECT_EQ(moving.update(mesh.view()).action, UpdateAction::refit);
    EXPECT_FALSE(closest_hit(moving.tree(), mesh.view(), {}));
}

TEST(ExpectedSteps, CountsTheRootAndWeighsTheRest) {
    // One leaf in a node: both are met by every ray that meets the box.
    const Mesh mesh = test::triangle_soup(7, 4);
    const auto wide = WideTree::build(
        Tree::build(triangle_boxes(mesh.view()), {.leaf_size = 15, .traversal_cost = 1e6}),
        mesh.view());
    EXPECT_DOUBLE_EQ(expected_steps(wide), 2.0);
    EXPECT_EQ(expected_steps(WideTree()), 0.0);
}

// Lauterbach 2010, section 4.2, by hand: two unit cubes side by side, then ten apart. The node's
// half area grows from 5 to 25, that of its children stays 6 in all: (25 - 5) / 6.
TEST(AreaRatioRule, EqualsAHandExample) {
    const std::vector<geometry::Aabb> close = {{{0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F}},
                                               {{1.0F, 0.0F, 0.0F}, {2.0F, 1.0F, 1.0F}}};
    const std::vector<geometry::Aabb> apart = {close[0],
                                               {{11.0F, 0.0F, 0.0F}, {12.0F, 1.0F, 1.0F}}};
    Tree tree = Tree::build(close, {.leaf_size = 1});
    const AreaRatioRule rule(tree);
    EXPECT_EQ(rule.growth(tree), 0.0);
    tree.refit(apart);
    EXPECT_NEAR(rule.growth(tree), 20.0 / 6.0, 1e-6);
    EXPECT_GT(rule.growth(tree), AreaRatioRule::kThreshold);
}

}  // namespace
}  // namespace earshot::bvh
