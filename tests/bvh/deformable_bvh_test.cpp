// SPDX-License-Identifier: MIT
#include "earshot/bvh/deformable_bvh.h"

#include "earshot/base/random.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/wide_ray.h"

#include <gtest/gtest.h>

#include "support/drifting_city.h"
#include "support/meshes.h"
#include <algorithm>
#include <cmath>
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
    DeformableBvh moving(mesh.view(), options, executor);
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

TEST(DeformableBvh, CountsWhatItDoes) {
    const Mesh mesh = test::triangle_soup(1, 600);
    DeformableBvh moving(mesh.view(), {.queries_per_update = 1e6});
    EXPECT_EQ(moving.update_statistics(), UpdateStatistics{});
    UpdateStatistics expected;
    for (int frame = 1; frame <= 20; ++frame) {
        const Mesh now = exploded(mesh, 0.05 * frame);
        switch (moving.update(now.view()).action) {
            case UpdateAction::refit:
                ++expected.refits;
                break;
            case UpdateAction::repair:
                ++expected.repairs;
                break;
            case UpdateAction::rebuild:
                ++expected.rebuilds;
                break;
        }
    }
    EXPECT_EQ(moving.update_statistics(), expected);
    EXPECT_GT(expected.repairs + expected.rebuilds, 0U);
}

TEST(DeformableBvh, AnswersAsBruteForceWhateverItDoes) {
    const Mesh mesh = test::triangle_soup(1, 600);
    for (const double rays : {0.0, 2e3, 1e5, 1e9}) {
        DeformableBvh moving(mesh.view(), {.queries_per_update = rays});
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

TEST(DeformableBvh, RepairsTheMoreTheMoreRaysAreTraced) {
    const Mesh mesh = test::triangle_soup(4, 3000);
    const auto none = follow(mesh, {.queries_per_update = 0.0}, 1);
    EXPECT_EQ(count_of(none, UpdateAction::refit), none.size());
    const auto some = follow(mesh, {.queries_per_update = 3e3}, 1);
    const auto many = follow(mesh, {.queries_per_update = 1e6}, 1);
    EXPECT_GT(count_of(some, UpdateAction::repair) + count_of(some, UpdateAction::rebuild), 0U);
    EXPECT_GT(count_of(many, UpdateAction::rebuild), count_of(some, UpdateAction::rebuild));
    EXPECT_LT(many.back().sah_cost, 0.8 * none.back().sah_cost);
}

TEST(DeformableBvh, DecidesTheSameForAnyNumberOfThreads) {
    const Mesh mesh = test::triangle_soup(5, 3000);
    const auto serial = follow(mesh, {.queries_per_update = 2e4}, 1);
    const auto parallel = follow(mesh, {.queries_per_update = 2e4}, 8);
    for (std::size_t i = 0; i < serial.size(); ++i) {
        EXPECT_EQ(serial[i].action, parallel[i].action) << i;
        EXPECT_EQ(serial[i].sah_cost, parallel[i].sah_cost) << i;
    }
}

TEST(DeformableBvh, DecidesAndAnswersTheSameToldWhatHasMoved) {
    const Mesh mesh = test::triangle_soup(4, 2000);
    DeformableBvh told(mesh.view()), not_told(mesh.view());
    Mesh now = mesh;
    std::size_t changes = 0;
    for (int frame = 1; frame <= 30; ++frame) {
        const std::vector<Vec3> before = now.positions;
        // Mostly some triangles, so that partial refits and full ones take turns.
        const std::size_t moving = frame % 7 == 0 ? mesh.triangles.size() : 150;
        for (std::size_t i = 0; i < moving; ++i) {
            for (const geometry::VertexId vertex : mesh.triangles[i]) {
                now.positions[vertex] += 0.1 * test::random_point(78, i);
            }
        }
        const UpdateReport report = told.update(now.view(), moved_triangles(now.view(), before));
        const UpdateReport expected = not_told.update(now.view());
        EXPECT_EQ(report.action, expected.action) << frame;
        EXPECT_EQ(report.sah_cost_after_refit, expected.sah_cost_after_refit) << frame;
        EXPECT_EQ(report.sah_cost, expected.sah_cost) << frame;
        EXPECT_EQ(told.version(), not_told.version());
        changes += report.action == UpdateAction::refit ? 0 : 1;
    }
    EXPECT_GT(changes, 0U);
    for (std::uint64_t i = 0; i < 200; ++i) {
        const Ray ray{2.0 * test::random_point(5, i), test::random_point(6, i)};
        EXPECT_EQ(told.view().closest_hit(ray), brute_force::closest_hit(now.view(), ray));
    }
}

/// Six limbs of small triangles that swing about pivots close to each other, each with its own
/// phase. What is built where limbs cross is bad where they are apart.
Mesh swinging_limbs(double time) {
    constexpr double kTurn = 6.283185307179586;
    Mesh mesh;
    for (std::uint64_t limb = 0; limb < 6; ++limb) {
        const double phase = kTurn * random(6, 0, limb);
        const double angle = 0.6 * (std::sin(kTurn * time + phase) - std::sin(phase));
        const double c = std::cos(angle), s = std::sin(angle);
        for (std::uint64_t i = 0; i < 400; ++i) {
            const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
            for (std::uint64_t k = 0; k < 3; ++k) {
                const Vec3 p = Vec3(0.0, -random(7, limb, i), 0.0) +
                               0.06 * test::random_point(100 + limb, 3 * i + k);
                mesh.positions.push_back(0.4 * test::random_point(5, limb) +
                                         Vec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z));
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
    }
    return mesh;
}

// What is built for poses far from the first must not be kept where the first tree is better.
TEST(DeformableBvh, IsNeverWorseThanRefitsAloneOnCyclicMotion) {
    for (const double rays : {1e5, 1e6, 1e7}) {
        DeformableBvh moving(swinging_limbs(0.0).view(), {.queries_per_update = rays});
        WideTree refitted = moving.tree();
        std::size_t restored = 0;
        for (int frame = 1; frame <= 120; ++frame) {
            const Mesh now = swinging_limbs(frame / 40.0);
            const UpdateReport report = moving.update(now.view());
            refitted.refit(now.view());
            EXPECT_LE(report.sah_cost, 1.03 * sah_cost(refitted))
                << rays << " rays, frame " << frame;
            EXPECT_EQ(report.sah_cost, sah_cost(moving.tree()));
            restored += report.is_restored ? 1 : 0;
        }
        EXPECT_GT(restored, 0U) << rays << " rays";
    }
}

TEST(DeformableBvh, RestoresTheTreeOfBoxesWhenAPoseComesBack) {
    const Mesh mesh = test::triangle_soup(10, 2000);
    DeformableBvh moving(triangle_boxes(mesh.view()), {.queries_per_update = 1e6});
    Tree refitted = moving.binary_tree();
    for (int frame = 1; frame <= 60; ++frame) {
        const auto boxes =
            triangle_boxes(exploded(mesh, 0.25 * (1.0 - std::cos(0.21 * frame))).view());
        const UpdateReport report = moving.update(boxes);
        refitted.refit(boxes);
        EXPECT_LE(report.sah_cost, 1.03 * sah_cost(refitted)) << "frame " << frame;
        EXPECT_EQ(report.sah_cost, sah_cost(moving.binary_tree()));
    }
}

// Of 100 steps, refits alone cost twice as much as a new tree in the end. A repair takes as long as
// 7 refits, a rebuild as 10 (docs/algorithms/bvh-deformation.md).
TEST(DeformableBvh, HoldsADriftingCityAtTheCostOfNewTrees) {
    const test::DriftingCity city;
    DeformableBvh moving(city.at(0.0).view(), {.queries_per_update = 1e5});
    WideTree refitted = moving.tree();
    Mesh now;
    for (int step = 1; step <= 100; ++step) {
        now = city.at(step);
        moving.update(now.view());
        refitted.refit(now.view());
    }
    const double fresh =
        sah_cost(WideTree::build(Tree::build(triangle_boxes(now.view())), now.view()));
    EXPECT_GT(sah_cost(refitted), 2.0 * fresh);
    EXPECT_LE(sah_cost(moving.tree()), 1.1 * fresh);
    const UpdateStatistics& counts = moving.update_statistics();
    EXPECT_GT(counts.repairs, 0U);
    EXPECT_LE(100 + 6 * counts.repairs + 9 * counts.rebuilds, 3 * 100);
}

TEST(DeformableBvh, LeavesARestingMeshAlone) {
    const Mesh mesh = test::triangle_soup(6, 500);
    DeformableBvh moving(mesh.view(), {.queries_per_update = 1e9});
    const std::uint64_t version = moving.version();
    for (int frame = 0; frame < 5; ++frame) {
        EXPECT_EQ(moving.update(mesh.view()).action, UpdateAction::refit);
    }
    EXPECT_EQ(moving.version(), version);
}

TEST(DeformableBvh, HoldsAnEmptyMesh) {
    const Mesh mesh;
    DeformableBvh moving(mesh.view());
    EXPECT_EQ(moving.update(mesh.view()).action, UpdateAction::refit);
    EXPECT_FALSE(closest_hit(moving.tree(), mesh.view(), {}));
}

}  // namespace
}  // namespace earshot::bvh
