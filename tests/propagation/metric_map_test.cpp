// SPDX-License-Identifier: MIT
#include "earshot/propagation/metric_map.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "map_room.h"
#include <algorithm>
#include <cmath>
#include <set>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

std::vector<MapMetric> metrics_of(std::initializer_list<const char*> names) {
    std::vector<MapMetric> metrics;
    for (const char* name : names) {
        metrics.emplace_back(name, audio::Bands::octaves());
    }
    return metrics;
}

MapOptions few_rays(std::size_t rays) {
    return {.simulation = {.specular_order = 2, .rays = rays}};
}

bool are_equal(const MapValue& a, const MapValue& b) {
    return a.value == b.value && a.standard_error == b.standard_error;
}

TEST(MapMetric, NamesKeysAndBands) {
    const audio::Bands& bands = audio::Bands::octaves();
    EXPECT_EQ(MapMetric("t30:125", bands).name(), "t30:125");
    EXPECT_EQ(MapMetric("c80", bands).unit(), "dB");
    EXPECT_NEAR(MapMetric("t30", bands).just_noticeable_difference(2.0), 0.1, 1e-15);
    EXPECT_NEAR(MapMetric("sti", bands).just_noticeable_difference(2.0), 0.03, 1e-15);
    EXPECT_TRUE(MapMetric("sti", bands).larger_is_better());
    EXPECT_FALSE(MapMetric("ts", bands).larger_is_better());
    for (const char* wrong : {"", "t3O", "t30:", "t30:126", "sti:500", "t30:500x"}) {
        EXPECT_THROW(MapMetric(wrong, bands), Error) << wrong;
    }
}

// The same points as listeners of a simulation, whose rain falls everywhere.
TEST(MetricMap, ValuesAreThoseOfListenersWithinStandardErrors) {
    Scene scene = room_with_block();
    for (Material& material : scene.materials) {
        material.scattering = EnergyCoefficient(0.4);
    }
    const auto metrics = metrics_of({"sti", "t30", "c80", "t30:1000", "g", "ts"});
    const MapPointList points = {
        {2.1, 1.2, 4.3}, {6.6, 1.2, 0.8}, {7.7, 1.1, 5.6}, {4.6, 0.9, 2.6}, {5.0, 1.2, 3.0}};
    MapOptions options = few_rays(40000);
    const MetricMap map = compute_metric_map(scene, 0.0, points, metrics, options);

    for (const Vec3& point : points) {
        scene.listeners.push_back({.name = "l", .position = point});
    }
    options.simulation.seed = 77;  // rays of its own
    Simulator simulator(scene, options.simulation);
    double chi_squared = 0.0;
    std::size_t compared = 0;
    for (const PairResult& pair : simulator.run()) {
        const audio::RoomMetrics found =
            audio::energy_metrics(audio::Bands::octaves(),
                                  arrivals_of(pair),
                                  pair.late,
                                  {.replicates = &pair.late_replicates});
        for (std::size_t m = 0; m < metrics.size(); ++m) {
            const MapValue expected = metrics[m].read(found);
            const MapValue& value = map.value(pair.listener, 0, m);
            ASSERT_TRUE(expected.value && value.value) << metrics[m].name();
            const double error = std::hypot(*expected.standard_error, *value.standard_error);
            const double deviation = (*value.value - *expected.value) / error;
            EXPECT_LT(std::abs(deviation), 4.0) << metrics[m].name();
            chi_squared += deviation * deviation;
            ++compared;
        }
    }
    // The errors are neither too small nor too large. Metrics of one point depend on each other.
    EXPECT_LT(chi_squared / static_cast<double>(compared), 2.0);
    EXPECT_GT(chi_squared / static_cast<double>(compared), 0.2);
}

TEST(MetricMap, APointDependsOnNoOtherAndNotOnThreads) {
    const Scene scene = room_with_block();
    const auto metrics = metrics_of({"sti", "c80"});
    const MapOptions options = few_rays(4096);
    const MapPointList one = {{2.1, 1.2, 4.3}};
    const MapPointList many = {{6, 1.2, 1}, {2.1, 1.2, 4.3}, {2.2, 1.2, 4.3}, {3.5, 1, 2.5}};
    const MetricMap alone = compute_metric_map(scene, 0.0, one, metrics, options);
    Executor executor(3);
    const MetricMap among = compute_metric_map(scene, 0.0, many, metrics, options, executor);
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        EXPECT_TRUE(are_equal(alone.value(0, 0, m), among.value(1, 0, m)));
    }
    EXPECT_EQ(among.exclusions[3], PointExclusion::in_solid);
    EXPECT_FALSE(among.value(3, 0, 0).value);
    EXPECT_EQ(among.excluded.in_solid, 1U);
    EXPECT_EQ(among.points_evaluated, 3U);
}

TEST(MetricMap, RefinedMapsAreTheSameForAnyThreadsAndHoldTheirPoints) {
    const Scene scene = room_with_block();
    const auto metrics = metrics_of({"c80", "g"});
    MapOptions options = few_rays(4096);
    options.step = 0.5;
    options.coarse_step = 2.0;
    const MapRectangle area{0.2, 0.2, 7.8, 5.8, 1.0};
    const MetricMap map = compute_metric_map(scene, 0.0, area, metrics, options);
    Executor executor(4);
    const MetricMap again = compute_metric_map(scene, 0.0, area, metrics, options, executor);
    ASSERT_EQ(map.cells.size(), again.cells.size());
    std::set<std::uint32_t> sizes;
    double total = 0.0;
    for (std::size_t k = 0; k < map.cells.size(); ++k) {
        EXPECT_EQ(map.cells[k].cell, again.cells[k].cell);
        EXPECT_EQ(map.cells[k].point, again.cells[k].point);
        sizes.insert(map.cells[k].cell.size);
        total += map.area(k);
        for (std::size_t m = 0; m < metrics.size(); ++m) {
            EXPECT_TRUE(are_equal(map.value(k, 0, m), again.value(k, 0, m)));
        }
    }
    // G falls quickly near the source.
    EXPECT_GT(sizes.size(), 1U);
    const double cell = map.lattice.cell_width() * map.lattice.cell_depth();
    EXPECT_NEAR(total, 7.6 * 5.6 - cell * static_cast<double>(map.excluded.total()), 1e-9);
    EXPECT_TRUE(std::is_sorted(map.cells.begin(),
                               map.cells.end(),
                               [](const auto& a, const auto& b) { return a.cell < b.cell; }));
}

TEST(MetricMap, WhatCannotBeMappedIsAnError) {
    Scene scene = room_with_block();
    const auto metrics = metrics_of({"c80"});
    const MapOptions options = few_rays(0);
    const MapRectangle area{1, 1, 2, 2, 1.2};
    EXPECT_THROW(compute_metric_map(scene, 0.0, area, {}, options), Error);
    EXPECT_THROW(compute_metric_map(scene, 0.0, MapRectangle{20, 20, 22, 22, 1}, metrics, options),
                 Error);
    EXPECT_THROW(compute_metric_map(scene, 0.0, MapPointList{{3.5, 1, 2.5}}, metrics, options),
                 Error);
    MapOptions wrong = options;
    wrong.coarse_step = 0.1;
    EXPECT_THROW(compute_metric_map(scene, 0.0, area, metrics, wrong), Error);
    scene.sources.clear();
    EXPECT_THROW(compute_metric_map(scene, 0.0, area, metrics, options), Error);
}

}  // namespace
}  // namespace earshot::propagation
