// SPDX-License-Identifier: MIT
#include "earshot/propagation/cost_forecast.h"

#include "earshot/frustum/path_finder.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "support/test_paths.h"

namespace earshot::propagation {
namespace {

Scene coupled_rooms() {
    return io::load_scene(test::source_file("scenes/coupled_rooms.gltf")).scene;
}

frustum::TraceResult traced(const Scene& scene, int order, const frustum::BeamSample& sample) {
    Simulator simulator(scene);
    const frustum::PathFinder finder(simulator.scene_view(),
                                     {.trace = {.max_order = order}, .sample = sample});
    const std::vector<geometry::Vec3> listeners{scene.position_at(scene.listeners[0], 0.0)};
    return finder.find(scene.position_at(scene.sources[0], 0.0), finder.trace_listeners(listeners));
}

TEST(CostForecast, AShareOfTheFrustaTellsHowManyThereAre) {
    const Scene scene = coupled_rooms();
    const auto all = traced(scene, 6, {});
    const auto above = traced(scene, 6, {.order = 3, .share = 0.0});
    EXPECT_LT(above.statistics.frusta, all.statistics.frusta / 4);
    const auto part = traced(scene, 6, {.order = 3, .share = 0.3});
    EXPECT_LT(part.paths.size(), all.paths.size());
    for (const auto count :
         {&frustum::TraceStatistics::frusta, &frustum::TraceStatistics::candidates}) {
        const auto below = [&](const frustum::TraceResult& result) {
            return static_cast<double>(result.statistics.*count - above.statistics.*count);
        };
        EXPECT_NEAR(below(part) / 0.3, below(all), 0.35 * below(all));
    }
    EXPECT_EQ(traced(scene, 4, {.order = 1, .share = 1.0}).paths, traced(scene, 4, {}).paths);
}

TEST(CostForecast, TellsOrdersTwoToSix) {
    const Scene scene = coupled_rooms();
    Executor executor;
    // No machine traces an order in a quarter of a microsecond, and none needs days.
    constexpr double kTooShort = 1e-6, kAmple = 1e6;
    for (const double budget : {kTooShort, 0.001, 0.05, kAmple}) {
        const auto costs = forecast_costs(scene, 0.0, budget, executor);
        ASSERT_EQ(costs.size(), 5U);
        for (std::size_t i = 0; i < costs.size(); ++i) {
            EXPECT_EQ(costs[i].order, static_cast<int>(i) + 2);
            EXPECT_GT(costs[i].seconds, 0.0);
            EXPECT_TRUE(i == 0 || costs[i].is_measured <= costs[i - 1].is_measured);
        }
        if (budget == kTooShort || budget == kAmple) {
            EXPECT_EQ(costs.front().is_measured, budget == kAmple);
            EXPECT_EQ(costs.back().is_measured, budget == kAmple);
        }
    }
    EXPECT_TRUE(forecast_costs(shoebox_room({6, 3, 4}), 0.0, 1.0, executor).empty());
}

}  // namespace
}  // namespace earshot::propagation
