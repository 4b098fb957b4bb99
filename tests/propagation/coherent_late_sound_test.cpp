// SPDX-License-Identifier: MIT
#include "earshot/propagation/coherent_late_sound.h"

#include "earshot/audio/temporal_difference.h"
#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/standard_error.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "one_material_scene.h"
#include "support/sampling_rivals.h"
#include "support/test_paths.h"
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

using audio::EnergyHistogram;
using geometry::Vec3;

constexpr std::size_t kBand = 5;  // 1 kHz

RaySource source_at(const Vec3& position) {
    return {.pose = {.position = position}};
}

/// Everything that a listener could receive.
EnergyHistogram full_sum(const CoherentLateSound& late, const Vec3& listener) {
    std::vector<WeightedSample> all;
    for (std::size_t i = 0; i < late.virtual_sources(); ++i) {
        all.push_back({i, 1.0});
    }
    return late.energy_of(listener, all);
}

std::uint64_t digest_of(const EnergyHistogram& histogram) {
    Digest digest;
    for (const audio::Spectrum& energy : histogram.energy) {
        digest.add(energy);
    }
    for (const auto& parts : histogram.directions) {
        digest.add(parts);
    }
    return digest.value();
}

/// Of a span of bins, in the band of 1 kHz.
double energy_in(const EnergyHistogram& histogram, std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t n = first; n < last; ++n) {
        sum += histogram.energy[n][kBand];
    }
    return sum;
}

TEST(CoherentLateSound, HasTheMeanOfRaysWhereSurfacesScatterEverything) {
    const OneMaterialScene room(box_mesh({6, 3, 5}), 0.3, 1.0);
    const RaySource source = source_at({1.5, 1.2, 1.1});
    const std::vector<Vec3> listeners = {{4.2, 1.7, 3.4}};
    constexpr double kLength = 0.3;
    const LateEnergy rays = trace_late_rays(
        room.scene(), source, listeners, {.rays = 20000, .seed = 77, .length = kLength});
    constexpr std::size_t kSpan = 50;
    for (std::size_t first = 0; first < 300; first += kSpan) {
        std::vector<double> sums;
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            CoherentLateSound late({.rays = 1024, .seed = seed, .length = kLength});
            late.update(room.scene(), source);
            sums.push_back(energy_in(full_sum(late, listeners[0]), first, first + kSpan));
        }
        double variance = 0.0;
        for (std::size_t n = first; n < first + kSpan; ++n) {
            const double error = rays.listeners[0].error[n][kBand];
            variance += error * error;
        }
        const double error = standard_error_of_mean(sums);
        const double mean = std::accumulate(sums.begin(), sums.end(), 0.0) / 12.0;
        const double expected = energy_in(rays.listeners[0], first, first + kSpan);
        EXPECT_NEAR(mean, expected, 4.0 * std::sqrt(error * error + variance)) << first;
        EXPECT_LT(std::sqrt(error * error + variance), 0.03 * expected) << first;
    }
}

TEST(CoherentLateSound, LeavesOutWhatExactPathsHold) {
    const OneMaterialScene room(box_mesh({6, 3, 5}), 0.3, 0.0);
    const auto energy_of_order = [&](int order) {
        CoherentLateSound late({.rays = 256, .length = 0.05, .specular_order = order});
        late.update(room.scene(), source_at({1.5, 1.2, 1.1}));
        return energy_in(full_sum(late, {4.2, 1.7, 3.4}), 0, 50);
    };
    EXPECT_EQ(energy_of_order(1000), 0.0);
    EXPECT_GT(energy_of_order(1), 0.0);
    EXPECT_LT(energy_of_order(1), energy_of_order(0));
}

TEST(CoherentLateSound, ABudgetForAllGivesTheFullSum) {
    const OneMaterialScene room(box_mesh({6, 3, 5}), 0.3, 0.4);
    CoherentLateSound late({.rays = 64, .length = 0.2, .report_directions = true});
    late.update(room.scene(), source_at({1.5, 1.2, 1.1}));
    const std::vector<Vec3> listeners = {{4.2, 1.7, 3.4}, {2.0, 1.0, 4.0}};
    const auto estimates = late.estimate(listeners, 1000 * late.virtual_sources());
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        EXPECT_EQ(digest_of(estimates[k]), digest_of(full_sum(late, listeners[k])));
    }
    // A listener's depends on no other.
    const auto alone = late.estimate(std::span(listeners).subspan(1), 100);
    EXPECT_EQ(digest_of(alone[0]), digest_of(late.estimate(listeners, 100)[1]));
}

TEST(CoherentLateSound, DirectionsHoldTheEnergyWithoutTheAir) {
    const OneMaterialScene room(box_mesh({6, 3, 5}), 0.3, 0.4);
    CoherentLateSound late(
        {.rays = 64, .length = 0.2, .air_absorption = false, .report_directions = true});
    late.update(room.scene(), source_at({1.5, 1.2, 1.1}));
    const EnergyHistogram histogram = late.estimate(std::vector<Vec3>{{4.2, 1.7, 3.4}}, 200)[0];
    ASSERT_EQ(histogram.directions.size(), 10);
    for (std::size_t interval = 0; interval < 10; ++interval) {
        double sum = 0.0;
        for (const audio::Spectrum& part : histogram.directions[interval]) {
            sum += part[kBand];
        }
        EXPECT_NEAR(sum, energy_in(histogram, 20 * interval, 20 * interval + 20), 1e-12 * sum);
    }
    EXPECT_GT(histogram.reflection_growth, 0.0);
}

/// door.gltf at instants, whose door moves.
struct DoorScene {
    Scene scene = io::load_scene(test::source_file("scenes/door.gltf")).scene;
    Simulator simulator{scene};
    Vec3 source = scene.position_at(scene.sources.front(), 0.0);
    Vec3 listener = scene.position_at(scene.listeners.front(), 0.0);
};

TEST(CoherentLateSound, FollowsASceneLikeAFreshStart) {
    DoorScene door;
    const RayOptions options = {.rays = 100, .length = 0.1};
    CoherentLateSound late(options);
    std::size_t legs_of_start = 0;
    const std::vector<double> times = {0.0, 0.0, 0.5, 0.55, 2.0, 3.5, 0.0};
    for (std::size_t k = 0; k < times.size(); ++k) {
        door.simulator.set_time(times[k]);
        const std::size_t traced = late.update(door.simulator.ray_scene(), source_at(door.source));
        CoherentLateSound fresh(options);
        const std::size_t all = fresh.update(door.simulator.ray_scene(), source_at(door.source));
        EXPECT_EQ(late.virtual_sources(), fresh.virtual_sources());
        EXPECT_EQ(digest_of(full_sum(late, door.listener)),
                  digest_of(full_sum(fresh, door.listener)))
            << times[k];
        if (k == 0) {
            legs_of_start = traced;
            EXPECT_EQ(traced, all);
        } else if (times[k] == times[k - 1]) {
            EXPECT_EQ(traced, 0);
        } else {
            EXPECT_LT(traced, all);
        }
    }
    EXPECT_GT(legs_of_start, 100);
    // A source that moves starts all rays anew.
    CoherentLateSound fresh(options);
    const RaySource moved = source_at(door.source + Vec3(0.1, 0.0, 0.0));
    EXPECT_EQ(late.update(door.simulator.ray_scene(), moved),
              fresh.update(door.simulator.ray_scene(), moved));
    EXPECT_EQ(digest_of(full_sum(late, door.listener)), digest_of(full_sum(fresh, door.listener)));
}

TEST(CoherentLateSound, HasTheSameBitsForAnyNumberOfThreads) {
    DoorScene door;
    std::vector<std::uint64_t> digests;
    for (const int threads : {1, 2, 7}) {
        Executor executor(threads);
        CoherentLateSound late({.rays = 300, .length = 0.1, .report_directions = true});
        for (const double time : {0.0, 0.7}) {
            door.simulator.set_time(time);
            late.update(door.simulator.ray_scene(), source_at(door.source), executor);
        }
        Digest digest;
        for (const EnergyHistogram& histogram :
             late.estimate(std::vector{door.listener, door.source}, 64, executor)) {
            digest.add(digest_of(histogram));
        }
        digests.push_back(digest.value());
    }
    EXPECT_EQ(digests[0], digests[1]);
    EXPECT_EQ(digests[0], digests[2]);
}

std::vector<SamplingKey> keys_of(std::size_t count, std::uint64_t seed) {
    std::vector<SamplingKey> keys;
    for (std::size_t i = 0; i < count; ++i) {
        keys.push_back(sampling_key(i, seed));
    }
    return keys;
}

/// A walk through the classroom, 5 cm per update.
struct Walk {
    Scene scene = io::load_scene(test::source_file("scenes/classroom.gltf")).scene;
    Simulator simulator{scene};
    CoherentLateSound late{{.rays = 128, .length = 0.3}};

    Walk() {
        late.update(simulator.ray_scene(),
                    source_at(scene.position_at(scene.listeners.front(), 0.0)));
    }
    Vec3 listener(std::size_t update) const {
        return scene.position_at(scene.sources.front(), 0.0) +
               Vec3(0.05 * static_cast<double>(update), 0.0, 0.0);
    }
};

TEST(CoherentLateSound, IsUnbiased) {
    Walk walk;
    const Vec3 listener = walk.listener(0);
    const std::vector<double> importances = walk.late.importances(listener);
    const EnergyHistogram exact = full_sum(walk.late, listener);
    constexpr std::uint64_t kSeeds = 200;
    std::vector<std::vector<double>> sums(3);
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const EnergyHistogram estimate = walk.late.energy_of(
            listener, coherent_samples(importances, keys_of(importances.size(), seed), 100));
        for (std::size_t part = 0; part < sums.size(); ++part) {
            sums[part].push_back(energy_in(estimate, 100 * part, 100 * part + 100));
        }
    }
    for (std::size_t part = 0; part < sums.size(); ++part) {
        const double mean = std::accumulate(sums[part].begin(), sums[part].end(), 0.0) / kSeeds;
        EXPECT_NEAR(mean,
                    energy_in(exact, 100 * part, 100 * part + 100),
                    4.0 * standard_error_of_mean(sums[part]))
            << part;
    }
}

TEST(CoherentLateSound, FlickersFarLessThanIndependentChoicesAndErrsNoMore) {
    Walk walk;
    std::vector<EnergyHistogram> exact, coherent, independent;
    constexpr std::size_t kBudget = 256;
    for (std::size_t update = 0; update < 12; ++update) {
        const Vec3 listener = walk.listener(update);
        exact.push_back(full_sum(walk.late, listener));
        coherent.push_back(walk.late.estimate(std::span(&listener, 1), kBudget)[0]);
        independent.push_back(walk.late.energy_of(
            listener,
            support::independent_samples(walk.late.importances(listener), kBudget, 1000 + update)));
    }
    const auto of_coherent = audio::temporal_difference(coherent, exact, 10);
    const auto of_independent = audio::temporal_difference(independent, exact, 10);
    EXPECT_LT(of_coherent.difference, 0.5 * of_independent.difference);
    EXPECT_LT(of_coherent.error, 1.1 * of_independent.error);
}

TEST(CoherentLateSound, RefusesOptionsOutOfRange) {
    EXPECT_THROW(CoherentLateSound({.rays = 0}), Error);
    EXPECT_THROW(CoherentLateSound({.length = 0.0}), Error);
    EXPECT_THROW(CoherentLateSound({.air = {.temperature_c = 500.0}}), Error);
}

}  // namespace
}  // namespace earshot::propagation
