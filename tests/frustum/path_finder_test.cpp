// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_finder.h"

#include "earshot/base/simd.h"
#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/find_specular_paths.h"

#include <gtest/gtest.h>

#include "frustum/quad_room.h"

namespace earshot::frustum {
namespace {

using geometry::Vec3;

std::vector<Vec3> moved(std::vector<Vec3> points, const Vec3& by) {
    for (Vec3& point : points) {
        point += by;
    }
    return points;
}

/// Of tracing beams: forward only, and with one and two reflections in subpaths of listeners.
struct Way {
    bool forward_only;
    std::size_t listener_count;
};
constexpr Way kWays[] = {{true, 1}, {false, 1000}, {false, 1}};

TEST(PathFinder, KeptTracesGiveThePathsOfAFreshSearch) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const RandomRoom random(seed, static_cast<int>(seed % 5));
        const SceneView scene_view = random.room.scene_view();
        const int order = static_cast<int>(seed % 4);
        for (const auto& [forward_only, listener_count] : kWays) {
            const PathFinder finder(scene_view,
                                    {.trace = {.max_order = order},
                                     .forward_only = forward_only,
                                     .listener_count = listener_count});
            auto source = finder.trace_source(random.source);
            auto listeners = finder.trace_listeners(random.listeners);
            const auto expect_fresh = [&](const Vec3& from, const std::vector<Vec3>& to) {
                const auto fresh = find_specular_paths(scene_view, from, to, {.max_order = order});
                EXPECT_EQ(finder.connect(source, listeners).paths, fresh.paths) << seed;
                EXPECT_EQ(finder.find(from, listeners).paths, fresh.paths) << seed;
            };
            expect_fresh(random.source, random.listeners);
            const auto there = moved(random.listeners, {0.01, 0.02, -0.015});
            listeners = finder.trace_listeners(there);
            expect_fresh(random.source, there);
            const Vec3 here = random.source + Vec3(-0.02, 0.01, 0.01);
            source = finder.trace_source(here);
            expect_fresh(here, there);
        }
    }
}

// Beside a wall, in the planes of boxes' faces, on a wall, in a corner: where the search from the
// listener knows least.
TEST(PathFinder, ListenersInThePlanesOfFacetsMissNothing) {
    std::size_t paths = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        QuadRoom room;
        room.add_box(Vec3(0.0), {5, 0, 0}, {0, 3, 0}, {0, 0, 4}, true);
        const double height = random_between(seed, 1, 0, 0.5, 1.5);
        room.add_box({1, 0, 1}, {0.5, 0, 0}, {0, height, 0}, {0, 0, 0.5});
        room.add_box({3, 0, 2}, {0.7, 0, 0.1}, {0, height, 0}, {-0.1, 0, 0.7});
        room.finish();
        const Vec3 source = {random_between(seed, 2, 0, 0.2, 4.8), 1.6, 0.5};
        const std::vector<Vec3> listeners = {{2.2, height, 1.7},    // beside the boxes' tops
                                             {1.2, height, 1.2},    // on one
                                             {1.5, 0.3, 2.5},       // in the plane of a side
                                             {2.0, 0.0, 3.0},       // on the floor
                                             {0.0, 0.0, 0.0},       // in a corner
                                             {4.0, 1e-13, 3.0},     // hardly above the floor
                                             {2.0, source.y, 3.5},  // level with the source
                                             source};
        const auto expected =
            find_specular_paths_brute_force(room.scene_view(), source, listeners, 3);
        for (const auto& [forward_only, listener_count] : kWays) {
            const PathFinder finder(room.scene_view(),
                                    {.trace = {.max_order = 3},
                                     .forward_only = forward_only,
                                     .listener_count = listener_count});
            const auto found = finder.find(source, finder.trace_listeners(listeners));
            EXPECT_EQ(found.paths, expected.paths) << seed << ' ' << listener_count;
        }
        paths += expected.paths.size();
    }
    EXPECT_GT(paths, 2000U);
}

TEST(PathFinder, ManyListenersGetWhatEachGetsAlone) {
    const RandomRoom random(3, 4);
    std::vector<Vec3> listeners;
    for (std::uint64_t i = 0; i < 600; ++i) {
        listeners.push_back(random.listeners[i % 3] + 0.3 * Vec3(earshot::random(1, 0, i) - 0.5,
                                                                 earshot::random(1, 1, i) - 0.5,
                                                                 earshot::random(1, 2, i) - 0.5));
    }
    const SceneView scene_view = random.room.scene_view();
    const auto all = find_specular_paths(scene_view, random.source, listeners, {.max_order = 2});
    std::vector<SpecularPath> one_by_one;
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        for (SpecularPath& path :
             find_specular_paths(
                 scene_view, random.source, std::span(&listeners[i], 1), {.max_order = 2})
                 .paths) {
            path.listener = i;
            one_by_one.push_back(std::move(path));
        }
    }
    EXPECT_EQ(all.paths, one_by_one);
    EXPECT_GT(all.paths.size(), 5000U);
}

// What is known not to be met first costs nothing but its own paths: it hides what it hides.
TEST(PathFinder, FirstFacetsLeaveOutThePathsThatBeginWithOthers) {
    std::size_t left_out = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const RandomRoom random(seed, 3);
        const SceneView scene_view = random.room.scene_view();
        std::vector<std::uint8_t> first;
        for (std::size_t facet = 0; facet < scene_view.facets.facets.size(); ++facet) {
            first.push_back(earshot::random(seed, 9, facet) < 0.5 ? 1 : 0);
        }
        for (const auto& [forward_only, listener_count] : kWays) {
            const int order = 1 + static_cast<int>(seed % 3);
            const PathFinder finder(scene_view,
                                    {.trace = {.max_order = order},
                                     .forward_only = forward_only,
                                     .listener_count = listener_count});
            const auto listeners = finder.trace_listeners(random.listeners);
            Executor& serial = Executor::serial();
            std::vector<SpecularPath> expected;
            for (const SpecularPath& path : finder.find(random.source, listeners).paths) {
                if (path.triangles.empty() ||
                    first[scene_view.facets.of_triangle[path.triangles[0]]] != 0) {
                    expected.push_back(path);
                } else {
                    ++left_out;
                }
            }
            EXPECT_EQ(finder.find(random.source, listeners, first, serial).paths, expected) << seed;
            const auto source = finder.trace_source(random.source, first, serial);
            EXPECT_EQ(finder.connect(source, listeners).paths, expected) << seed;
        }
    }
    EXPECT_GT(left_out, 1000U);
}

TEST(PathFinder, AnswersAndCountsDoNotDependOnThreadsOrInstructionSet) {
    const RandomRoom random(11, 5);
    const PathFinder finder(random.room.scene_view(), {.trace = {.max_order = 3}});
    const auto expected = finder.connect(finder.trace_source(random.source),
                                         finder.trace_listeners(random.listeners));
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        for (const int threads : {1, 2, 8}) {
            Executor executor(threads);
            const auto source = finder.trace_source(random.source, {}, executor);
            const auto listeners = finder.trace_listeners(random.listeners, executor);
            const auto found = finder.connect(source, listeners, executor);
            EXPECT_EQ(found.paths, expected.paths);
            EXPECT_EQ(found.statistics.candidates, expected.statistics.candidates);
        }
    }
    override_simd_target("auto");
}

}  // namespace
}  // namespace earshot::frustum
