// SPDX-License-Identifier: MIT
//
// Options::keep_traces while a part of the scene moves: the paths of a simulator that has never
// been at another instant, with a fraction of its work.

#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "propagation/moving_part.h"
#include "support/test_paths.h"
#include <cstddef>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

bool are_same(const std::vector<PairResult>& a, const std::vector<PairResult>& b) {
    if (a.size() != b.size()) {
        return false;
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i].paths.size() != b[i].paths.size()) {
            return false;
        }
        for (std::size_t k = 0; k < a[i].paths.size(); ++k) {
            const Path& p = a[i].paths[k];
            const Path& q = b[i].paths[k];
            if (p.points != q.points || p.triangles != q.triangles || p.pressure != q.pressure ||
                p.delay != q.delay || p.transmitted != q.transmitted ||
                p.materials != q.materials) {
                return false;
            }
        }
    }
    return true;
}

/// Of all updates.
struct Work {
    frustum::TraceStatistics kept, fresh;
    std::size_t different_paths = 0;
};

Work follow(const Scene& scene, Options options, int updates) {
    options.keep_traces = true;
    Simulator keeping(scene, options);
    keeping.run();
    options.keep_traces = false;
    Work work;
    for (int k = 1; k <= updates; ++k) {
        const double time = scene.mesh.duration() * k / updates;
        keeping.set_time(time);
        const auto kept = keeping.run();
        work.kept += keeping.statistics();
        Simulator fresh(scene, options);
        fresh.set_time(time);
        work.different_paths += are_same(kept, fresh.run()) ? 0 : 1;
        work.fresh += fresh.statistics();
    }
    return work;
}

Scene scene_of(const char* name) {
    return io::load_scene(test::source_file(std::string("scenes/") + name)).scene;
}

TEST(KeptTraces, DoorAndCurtainThatMoveLeaveThePathsOfFreshRuns) {
    for (const char* name : {"door.gltf", "curtain.gltf"}) {
        const Work work = follow(scene_of(name), {.specular_order = 3}, 100);
        EXPECT_EQ(work.different_paths, 0U) << name;
        EXPECT_GT(work.kept.kept_candidates, 0U) << name;
    }
}

TEST(KeptTraces, SoundGoesThroughADoorThatMoves) {
    Scene scene = scene_of("door.gltf");
    for (Material& material : scene.materials) {
        material.transmission = EnergyCoefficient(0.01);
    }
    const Work work = follow(scene, {.specular_order = 3, .transmission = true}, 20);
    EXPECT_EQ(work.different_paths, 0U);
}

TEST(KeptTraces, WorkFallsWhereOnePartOfManyMoves) {
    const Work work = follow(furnished_office(2, 3), {.specular_order = 3}, 4);
    EXPECT_EQ(work.different_paths, 0U);
    EXPECT_GT(work.fresh.frusta, 5 * work.kept.frusta);
    EXPECT_GT(work.fresh.candidates, 5 * work.kept.candidates);
}

// Of what moves behind walls nothing is traced again but the frusta around source and listener,
// which do not tell.
TEST(KeptTraces, WhatMovesInAnotherRoomCostsNextToNothing) {
    Scene scene = furnished_office(2, 2);
    SceneWithMovingPart building(std::move(scene), Vec3(0.0), Vec3(0.0));
    building.add_box({0.0, 0.0, -5.2}, {5.0, 2.8, -0.2}, 0, false, true);
    building.add_chair({1.5, 0.0, -3.0}, 1, true);
    const Work work =
        follow(building.finish(straight_way({0.4, 0.0, 0.3})), {.specular_order = 3}, 3);
    EXPECT_EQ(work.different_paths, 0U);
    EXPECT_EQ(work.kept.candidates, 0U);
    EXPECT_LE(work.kept.frusta, 3U * 2U * 6U);
}

TEST(KeptTraces, SourcesAndListenersMoveTogetherWithTheGeometry) {
    Scene scene = furnished_office(1, 2);
    Simulator keeping(scene, {.specular_order = 3, .keep_traces = true});
    for (int k = 0; k < 8; ++k) {
        if (k % 3 == 1) {
            scene.sources[0].position.x += 0.05;
        }
        if (k % 3 == 2) {
            scene.listeners[0].position.z -= 0.07;
        }
        const double time = 0.25 * (k / 2);
        keeping.set_time(time);
        Simulator fresh(scene, {.specular_order = 3});
        fresh.set_time(time);
        EXPECT_TRUE(are_same(keeping.run(), fresh.run())) << k;
    }
}

}  // namespace
}  // namespace earshot::propagation
