// SPDX-License-Identifier: MIT
// Which surface matters, against full runs with other materials.
#include "earshot/propagation/sensitivity.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/base/error.h"
#include "earshot/base/simd.h"
#include "earshot/base/standard_error.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

const audio::Bands& bands() {
    return audio::Bands::octaves();
}

/// A coefficient of a number per octave.
EnergyCoefficient per_octave(const audio::Spectrum& values) {
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t band = 0; band < bands().count(); ++band) {
        points.push_back({bands().nominal_hz()[band], values[band]});
    }
    return EnergyCoefficient(points);
}

/// A box whose six walls absorb and scatter unlike each other, and in each band alike or not.
Scene test_room(bool scatters_by_band) {
    Scene scene = shoebox_room({7.0, 3.0, 5.0});
    constexpr std::array<double, 6> kAbsorption = {0.1, 0.35, 0.08, 0.12, 0.2, 0.15};
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        audio::Spectrum absorption{}, scattering{};
        for (std::size_t band = 0; band < bands().count(); ++band) {
            absorption[band] = kAbsorption[i] * (0.6 + 0.08 * static_cast<double>(band));
            scattering[band] = 0.2 + 0.1 * static_cast<double>(i % 3) +
                               (scatters_by_band ? 0.04 * static_cast<double>(band) : 0.0);
        }
        scene.materials[i].absorption = per_octave(absorption);
        scene.materials[i].scattering = per_octave(scattering);
    }
    scene.sources.push_back({.name = "s", .position = {1.7, 1.5, 2.1}});
    scene.listeners.push_back({.name = "near a wall", .position = {5.9, 1.2, 4.6}});
    scene.listeners.push_back({.name = "in the room", .position = {4.2, 1.3, 1.9}});
    return scene;
}

Options options_for(std::size_t rays) {
    return {.specular_order = 3, .rays = rays, .report_materials = true};
}

std::vector<PairResult> results_of(const Scene& scene, const Options& options) {
    return Simulator(scene, options).run();
}

std::vector<audio::RoomMetrics> metrics_of(const Scene& scene, const Options& options) {
    std::vector<audio::RoomMetrics> metrics;
    for (const PairResult& pair : results_of(scene, options)) {
        metrics.push_back(audio::energy_metrics(bands(), arrivals_of(pair), pair.late));
    }
    return metrics;
}

/// The scene with another absorption of one material in one band.
Scene with_absorption(const Scene& scene, std::size_t material, std::size_t band, double change) {
    Scene result = scene;
    audio::Spectrum absorption = scene.materials[material].absorption.over(bands());
    absorption[band] += change;
    result.materials[material].absorption = per_octave(absorption);
    return result;
}

/// A derivative and its difference of full runs.
struct Comparison {
    std::string what;
    double derivative = 0.0, difference = 0.0;
};

/// Of T30, C80 and STI of every listener, by some materials and bands.
std::vector<Comparison> compare_with_full_runs(
    const Scene& scene,
    const Options& options,
    const std::vector<std::pair<std::size_t, std::size_t>>& parameters) {
    constexpr double kChange = 0.01;
    std::vector<PairSensitivity> found;
    for (const PairResult& pair : results_of(scene, options)) {
        found.push_back(pair_sensitivity(scene, pair, {.report_errors = false}));
    }
    std::vector<Comparison> result;
    for (const auto& [material, band] : parameters) {
        const auto more = metrics_of(with_absorption(scene, material, band, kChange), options);
        const auto less = metrics_of(with_absorption(scene, material, band, -kChange), options);
        for (std::size_t i = 0; i < found.size(); ++i) {
            const AbsorptionDerivatives& derivatives = found[i].materials[material].derivatives;
            const auto add = [&](const std::string& name, double derivative, auto of) {
                result.push_back({.what = name + ", " + scene.listeners[i].name + ", " +
                                          scene.materials[material].name,
                                  .derivative = derivative,
                                  .difference = (of(more[i]) - of(less[i])) / (2.0 * kChange)});
            };
            const std::size_t of_band = band;
            add("T30", derivatives.bands[band].reverberation_time_t30.value(), [&](const auto& m) {
                return m.bands[of_band].reverberation_time_t30.value();
            });
            add("C80", derivatives.bands[band].clarity_c80_db.value(), [&](const auto& m) {
                return m.bands[of_band].clarity_c80_db.value();
            });
            add("STI", derivatives.speech_bands[band].value(), [&](const auto& m) {
                return m.speech_transmission_index.value();
            });
        }
    }
    return result;
}

// Rays take the same ways with all materials where every band scatters alike and the band that
// changes does not decide when faint rays end.
TEST(Sensitivity, IsTheDifferenceOfFullRunsWithTheSameRays) {
    for (const Comparison& comparison : compare_with_full_runs(
             test_room(false), options_for(4000), {{0, 5}, {1, 4}, {2, 6}, {3, 3}, {5, 7}})) {
        EXPECT_NEAR(
            comparison.derivative, comparison.difference, 0.05 * std::abs(comparison.difference))
            << comparison.what;
    }
}

// Here random decisions depend on the absorption, and the runs of a difference take other ways: it
// has an error, which the spread over seeds tells.
TEST(Sensitivity, IsThatOfTheExpectedValuesWhereDecisionsDependOnTheAbsorption) {
    constexpr std::size_t kSeeds = 6;
    std::vector<std::vector<Comparison>> of_seed;
    for (std::size_t seed = 1; seed <= kSeeds; ++seed) {
        Options options = options_for(3000);
        options.seed = seed;
        of_seed.push_back(compare_with_full_runs(test_room(true), options, {{0, 5}, {1, 4}}));
    }
    for (std::size_t i = 0; i < of_seed.front().size(); ++i) {
        std::vector<double> apart;
        double difference = 0.0;
        for (const std::vector<Comparison>& comparisons : of_seed) {
            apart.push_back(comparisons[i].derivative - comparisons[i].difference);
            difference += comparisons[i].difference / kSeeds;
        }
        const double mean = std::accumulate(apart.begin(), apart.end(), 0.0) / kSeeds;
        // The quantile 0.999 of Student's t with five degrees of freedom is 5.9.
        EXPECT_LT(std::abs(mean), 0.05 * std::abs(difference) + 5.9 * standard_error_of_mean(apart))
            << of_seed.front()[i].what;
    }
}

// The jackknife's errors are the spread of the derivatives over seeds.
TEST(Sensitivity, StandardErrorsAreTheSpreadOverSeeds) {
    constexpr std::size_t kSeeds = 8;
    const Scene scene = test_room(true);
    std::vector<double> t30, sti;
    double t30_error = 0.0, sti_error = 0.0;
    for (std::size_t seed = 1; seed <= kSeeds; ++seed) {
        Options options = options_for(2 * 8192);
        options.seed = seed;
        const MaterialSensitivity floor =
            pair_sensitivity(scene, results_of(scene, options)[1]).materials[0];
        t30.push_back(floor.derivatives.mid.reverberation_time_t30.value());
        sti.push_back(floor.derivatives.speech_transmission_index.value());
        t30_error += floor.standard_errors.mid.reverberation_time_t30.value() / kSeeds;
        sti_error += floor.standard_errors.speech_transmission_index.value() / kSeeds;
    }
    // A spread of eight is known to a quarter.
    const double root = std::sqrt(static_cast<double>(kSeeds));
    EXPECT_NEAR(t30_error / (root * standard_error_of_mean(t30)), 1.0, 0.7);
    EXPECT_NEAR(sti_error / (root * standard_error_of_mean(sti)), 1.0, 0.7);
}

TEST(Sensitivity, OfADiffuseRoomIsThatOfEyringsTime) {
    // A cube whose walls scatter everything: the derivative of Eyring's time by the absorption of
    // the floor, a sixth of the surface.
    Scene scene = shoebox_room({5.0, 5.0, 5.0});
    constexpr double kAbsorption = 0.2;
    for (Material& material : scene.materials) {
        material.absorption = EnergyCoefficient(kAbsorption);
        material.scattering = EnergyCoefficient(1.0);
    }
    scene.sources.push_back({.name = "s", .position = {1.2, 1.7, 1.4}});
    scene.listeners.push_back({.name = "l", .position = {3.6, 2.2, 3.1}});
    Options options = options_for(20000);
    options.air_absorption = false;
    const PairResult pair = results_of(scene, options).front();
    const PairSensitivity found = pair_sensitivity(scene, pair);
    const double t30 = *found.metrics.bands[5].reverberation_time_t30;
    // T is in proportion to 1 / -ln(1 - mean absorption).
    const double expected = -t30 / 6.0 / ((1.0 - kAbsorption) * -std::log(1.0 - kAbsorption));
    for (const MaterialSensitivity& wall : found.materials) {
        EXPECT_NEAR(wall.derivatives.bands[5].reverberation_time_t30.value(),
                    expected,
                    0.08 * std::abs(expected));
        // Late sound met every wall, each as often as any other.
        EXPECT_GT(wall.energy.touched_after[5], 0.6);
        EXPECT_LE(wall.energy.touched_after[5], 1.0 + 1e-12);
        EXPECT_GT(wall.energy.reflections_after[5], wall.energy.reflections_before[5]);
        // Those next to the source absorb more.
        EXPECT_NEAR(
            wall.energy.absorbed_before[5] + wall.energy.absorbed_after[5], 1.0 / 6.0, 0.05);
    }
}

TEST(Sensitivity, CountsWhatMaterialsTouchAndAbsorb) {
    const Scene scene = test_room(false);
    Options options = options_for(4000);
    options.air_absorption = false;
    const std::vector<PairResult> pairs = results_of(scene, options);
    const PairSensitivity found = pair_sensitivity(scene, pairs[1]);
    double absorbed = 0.0;
    for (const MaterialSensitivity& material : found.materials) {
        absorbed += material.energy.absorbed_before[5] + material.energy.absorbed_after[5];
        EXPECT_LE(material.energy.touched_before[5], material.energy.reflections_before[5] + 1e-12);
        EXPECT_GT(material.energy.touched_before[5], 0.0);
        EXPECT_LT(material.energy.touched_before[5], 1.0);
    }
    EXPECT_NEAR(absorbed, 1.0, 1e-4);  // a closed room, after all its decay
}

TEST(Sensitivity, OfPathsAloneCountsTheirReflections) {
    const Scene scene = test_room(false);
    Options options = options_for(0);
    options.specular_order = 8;  // more than 80 ms of sound, as G needs
    const PairResult pair = results_of(scene, options)[1];
    const PairSensitivity found = pair_sensitivity(scene, pair);
    double all = 0.0, early = 0.0, touched = 0.0, reflections = 0.0;
    for (const Path& path : pair.paths) {
        const double energy = path.pressure[5] * path.pressure[5];
        const auto count = static_cast<double>(
            std::count(path.materials.begin(), path.materials.end(), std::uint32_t{0}));
        all += energy;
        reflections += count * energy;
        if (path.delay < pair.paths.front().delay + kEarlyLimit) {
            early += energy;
            touched += count > 0.0 ? energy : 0.0;
        }
    }
    const MaterialSensitivity& floor = found.materials[0];
    EXPECT_NEAR(floor.energy.touched_before[5], touched / early, 1e-3);
    EXPECT_EQ(floor.energy.absorbed_before[5], 0.0);
    EXPECT_TRUE(floor.standard_errors.bands.empty());
    const double absorption = scene.materials[0].absorption.over(bands())[5];
    EXPECT_NEAR(floor.derivatives.bands[5].strength_db.value(),
                -10.0 / std::log(10.0) * reflections / all / (1.0 - absorption),
                1e-9);
}

TEST(Sensitivity, LeavesOutWhatPassesThrough) {
    Scene scene = test_room(false);
    for (Material& material : scene.materials) {
        material.transmission = EnergyCoefficient(0.02);
    }
    Options options = options_for(0);
    options.specular_order = 2;
    options.transmission = true;
    scene.listeners = {{.name = "outside", .position = {4.2, 5.0, 1.9}}};
    const PairResult pair = results_of(scene, options).front();
    ASSERT_FALSE(pair.paths.empty());
    ASSERT_EQ(pair.paths.front().kind, PathKind::transmitted);
    const PairSensitivity found = pair_sensitivity(scene, pair);
    // All paths pass the ceiling once; some are reflected by the floor before.
    EXPECT_EQ(found.materials[1].energy.touched_before[5], 0.0);
    EXPECT_GT(found.materials[0].energy.touched_before[5], 0.0);
}

TEST(Sensitivity, OfAMaterialThatAbsorbsEverythingIsEmpty) {
    Scene scene = test_room(false);
    scene.materials[1].absorption = EnergyCoefficient(1.0);
    const PairResult pair = results_of(scene, options_for(1000))[1];
    const PairSensitivity found = pair_sensitivity(scene, pair);
    EXPECT_FALSE(found.materials[1].derivatives.bands[5].strength_db);
    EXPECT_FALSE(found.materials[1].derivatives.speech_bands[5]);
    EXPECT_FALSE(found.materials[1].derivatives.speech_transmission_index);
    EXPECT_TRUE(found.materials[0].derivatives.bands[5].strength_db);
    EXPECT_EQ(found.materials[1].energy.touched_after[5], 0.0);
    EXPECT_GT(found.materials[1].energy.absorbed_before[5], 0.1);
}

TEST(Sensitivity, RecordingChangesNoOtherResult) {
    const Scene scene = test_room(true);
    Options options = options_for(3000);
    const std::vector<PairResult> recorded = results_of(scene, options);
    options.report_materials = false;
    const std::vector<PairResult> plain = results_of(scene, options);
    for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_EQ(plain[i].late.energy, recorded[i].late.energy);
        EXPECT_EQ(plain[i].late.error, recorded[i].late.error);
        EXPECT_EQ(plain[i].late_materials.intervals(), 0u);
    }
}

/// All that a pair's sensitivity holds.
void append_numbers(const PairSensitivity& pair, std::vector<double>& numbers) {
    const auto append = [&](const audio::Spectrum& values) {
        numbers.insert(numbers.end(), values.begin(), values.end());
    };
    const auto append_metrics = [&](const audio::BandMetrics& metrics) {
        for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
            numbers.push_back((metrics.*kind.value).value_or(0.0));
        }
    };
    for (const MaterialSensitivity& material : pair.materials) {
        const MaterialEnergy& energy = material.energy;
        for (const audio::Spectrum* values : {&energy.touched_before,
                                              &energy.touched_after,
                                              &energy.reflections_before,
                                              &energy.reflections_after,
                                              &energy.absorbed_before,
                                              &energy.absorbed_after}) {
            append(*values);
        }
        for (const auto* of : {&material.derivatives, &material.standard_errors}) {
            std::for_each(of->bands.begin(), of->bands.end(), append_metrics);
            append_metrics(of->mid);
            for (const std::optional<double>& number : of->speech_bands) {
                numbers.push_back(number.value_or(0.0));
            }
            numbers.push_back(of->speech_transmission_index.value_or(0.0));
        }
    }
}

TEST(Sensitivity, HasTheSameBitsWithAnyThreadsAndInstructionSet) {
    const Scene scene = test_room(true);
    const Options options = options_for(6000);
    const auto numbers_with = [&](int threads) {
        Executor executor(threads);
        std::vector<double> numbers;
        for (const PairResult& pair : Simulator(scene, options, executor).run(executor)) {
            append_numbers(pair_sensitivity(scene, pair), numbers);
        }
        return numbers;
    };
    const std::vector<double> expected = numbers_with(1);
    EXPECT_EQ(expected, numbers_with(3));
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(expected, numbers_with(2)) << target;
    }
    override_simd_target("auto");
}

// What one listener hears does not depend on which others are asked.
TEST(Sensitivity, OfAPairDoesNotDependOnOthers) {
    Scene scene = test_room(false);
    Options options = options_for(60000);
    options.max_error = 0.08;
    const double among_others = *pair_sensitivity(scene, results_of(scene, options)[1])
                                     .materials[0]
                                     .derivatives.bands[5]
                                     .reverberation_time_t30;
    scene.listeners.erase(scene.listeners.begin());
    EXPECT_EQ(among_others,
              *pair_sensitivity(scene, results_of(scene, options)[0])
                   .materials[0]
                   .derivatives.bands[5]
                   .reverberation_time_t30);
}

TEST(Sensitivity, NeedsPathsAndMaterials) {
    const Scene scene = test_room(false);
    Options options = options_for(500);
    options.report_materials = false;
    EXPECT_THROW(pair_sensitivity(scene, results_of(scene, options)[0]), Error);
    options.report_materials = true;
    options.report_paths = false;
    EXPECT_THROW(pair_sensitivity(scene, results_of(scene, options)[0]), Error);
}

TEST(MaterialAreas, AreThoseOfTheTriangles) {
    const std::vector<double> areas = material_areas(test_room(false), 0.0);
    EXPECT_NEAR(areas[0], 35.0, 1e-12);  // floor
    EXPECT_NEAR(areas[2], 21.0, 1e-12);  // north
    EXPECT_NEAR(areas[3], 15.0, 1e-12);  // east
}

}  // namespace
}  // namespace earshot::propagation
