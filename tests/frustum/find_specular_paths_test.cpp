// SPDX-License-Identifier: MIT
#include "earshot/frustum/find_specular_paths.h"

#include "earshot/base/error.h"
#include "earshot/base/simd.h"
#include "earshot/frustum/brute_force.h"

#include <gtest/gtest.h>

#include "frustum/quad_room.h"
#include <algorithm>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

TraceResult trace(const RandomRoom& random, const TraceOptions& options) {
    return find_specular_paths(random.room.scene_view(), random.source, random.listeners, options);
}

TEST(FindSpecularPaths, CompleteModeEqualsBruteForce) {
    std::size_t paths = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const int boxes = static_cast<int>(seed % 7);
        const int order = boxes < 3 ? 3 : 2;
        const RandomRoom random(seed, boxes);
        const auto expected = find_specular_paths_brute_force(
            random.room.scene_view(), random.source, random.listeners, order);
        const auto found = trace(random, {.max_order = order});
        EXPECT_EQ(found.paths, expected.paths) << "seed " << seed;
        paths += expected.paths.size();
    }
    EXPECT_GT(paths, 3000U);
}

TEST(FindSpecularPaths, ResolutionChangesNothingInCompleteMode) {
    for (std::uint64_t seed = 100; seed < 110; ++seed) {
        const RandomRoom random(seed, 3);
        const auto expected = trace(random, {.max_order = 2}).paths;
        for (const int resolution : {1, 3, 8, 13, 64}) {
            EXPECT_EQ(
                trace(random, {.max_order = 2, .resolution = resolution, .box_lattice = false})
                    .paths,
                expected)
                << "seed " << seed << " resolution " << resolution;
        }
    }
}

TEST(FindSpecularPaths, SampledModeFindsOnlyTruePathsAndMoreOfThemWithMoreSamples) {
    std::size_t complete = 0;
    std::vector<std::size_t> sampled(3, 0);
    for (std::uint64_t seed = 200; seed < 220; ++seed) {
        const RandomRoom random(seed, 3);
        const auto expected = trace(random, {.max_order = 2}).paths;
        complete += expected.size();
        for (std::size_t i = 0; i < sampled.size(); ++i) {
            const auto found = trace(random,
                                     {.max_order = 2,
                                      .mode = Mode::sampled,
                                      .resolution = i == 0   ? 2
                                                    : i == 1 ? 8
                                                             : 64});
            sampled[i] += found.paths.size();
            for (const SpecularPath& path : found.paths) {
                EXPECT_NE(std::find(expected.begin(), expected.end(), path), expected.end())
                    << "seed " << seed;
            }
        }
    }
    EXPECT_LT(sampled[0], sampled[1]);
    EXPECT_LT(sampled[1], sampled[2]);
    EXPECT_GT(sampled[2], complete * 9 / 10);
}

TEST(FindSpecularPaths, AnswersDoNotDependOnThreadsOrInstructionSet) {
    const RandomRoom random(7, 5);
    const auto expected = trace(random, {.max_order = 2});
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        const auto found = find_specular_paths(
            random.room.scene_view(), random.source, random.listeners, {.max_order = 2}, executor);
        EXPECT_EQ(found.paths, expected.paths);
        EXPECT_EQ(found.statistics.frusta, expected.statistics.frusta);
        EXPECT_EQ(found.statistics.candidates, expected.statistics.candidates);
    }
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        const auto found = trace(random, {.max_order = 2});
        EXPECT_EQ(found.paths, expected.paths) << target;
        EXPECT_EQ(found.statistics.frusta, expected.statistics.frusta) << target;
    }
    override_simd_target("auto");
}

TEST(FindSpecularPaths, APathThroughACornerStandsOnce) {
    QuadRoom room;
    room.add_box(Vec3(0.0), {4, 0, 0}, {0, 3, 0}, {0, 0, 4}, true);
    room.finish();
    // Symmetric about the vertical plane through the edge x = 4, z = 4: the second-order path over
    // both walls meets them in the edge itself.
    const Vec3 source = {3.0, 1.0, 1.0};
    const std::vector<Vec3> listeners = {{1.0, 1.5, 3.0}, {3.0, 1.0, 1.0}};
    const auto found = find_specular_paths(room.scene_view(), source, listeners, {.max_order = 2});
    std::size_t of_first = 0;
    for (const SpecularPath& path : found.paths) {
        of_first += path.listener == 0 ? 1 : 0;
    }
    EXPECT_EQ(of_first, 1U + 6U + 18U);  // every image of the box once
    EXPECT_EQ(found.paths.size(), 2 * of_first);
    EXPECT_EQ(found.paths[of_first].length, 0.0);  // listener at the source
}

TEST(FindSpecularPaths, NothingArrivesInASealedBox) {
    QuadRoom room;
    room.add_box(Vec3(0.0), {6, 0, 0}, {0, 3, 0}, {0, 0, 5}, true);
    room.add_box({3, 1, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    room.finish();
    const std::vector<Vec3> listener = {{3.4, 1.6, 2.3}};
    EXPECT_TRUE(find_specular_paths(room.scene_view(), {1, 1, 1}, listener, {.max_order = 3})
                    .paths.empty());
}

TEST(FindSpecularPaths, AnEmptySceneHasTheDirectPathOnly) {
    QuadRoom room;
    room.finish();
    const std::vector<Vec3> listener = {{3.0, 4.0, 0.0}};
    const auto found = find_specular_paths(room.scene_view(), {0, 0, 0}, listener);
    ASSERT_EQ(found.paths.size(), 1U);
    EXPECT_EQ(found.paths[0].length, 5.0);
}

TEST(FindSpecularPaths, RefusesOptionsOutOfRange) {
    QuadRoom room;
    room.finish();
    const auto attempt = [&](const TraceOptions& options) {
        find_specular_paths(room.scene_view(), Vec3(0.0), {}, options);
    };
    EXPECT_THROW(attempt({.max_order = -1}), Error);
    EXPECT_THROW(attempt({.max_order = 65}), Error);
    EXPECT_THROW(attempt({.resolution = -1}), Error);
    EXPECT_THROW(attempt({.resolution = 1025}), Error);
}

TEST(FindDirectPaths, FindsWhatASearchOfOrderZeroFinds) {
    std::size_t found = 0, blocked = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const RandomRoom random(seed, static_cast<int>(seed % 12));
        const SceneView scene_view = random.room.scene_view();
        std::vector<Vec3> listeners = random.listeners;
        listeners.push_back(random.source);
        for (const double max_length : {1e9, 3.0}) {
            for (const double min_pressure : {0.0, 0.4}) {
                const TraceOptions options = {.max_order = 0,
                                              .max_length = max_length,
                                              .min_pressure = min_pressure,
                                              .box_lattice = false};
                const PlacedPairs pairs = pairs_in_the_air(random.source, listeners);
                const TraceResult direct = find_direct_paths(scene_view.bvh, pairs, options);
                const TraceResult expected =
                    find_specular_paths(scene_view, random.source, listeners, options);
                EXPECT_EQ(direct.paths, expected.paths) << seed;
                EXPECT_EQ(direct.statistics.candidates, expected.statistics.candidates);
                EXPECT_EQ(direct.statistics.paths, expected.statistics.paths);
                found += direct.paths.size();
                blocked += listeners.size() - direct.paths.size();
            }
        }
    }
    EXPECT_GT(found, 100U);
    EXPECT_GT(blocked, 100U);
}

}  // namespace
}  // namespace earshot::frustum
