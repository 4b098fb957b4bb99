// SPDX-License-Identifier: MIT
// Derivatives by absorption in scenes with paths and late sound, against full runs with other
// materials. Materials scatter alike in all bands and rays do not end by roulette, so that rays of
// two runs take the same ways. What is left to chance is which of the places near a listener that
// scatter are taken, as they are chosen by their energy; means over seeds tell how much that is.
#include "earshot/audio/energy_metrics.h"
#include "earshot/base/standard_error.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/propagation/sensitivity.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

constexpr std::size_t kFirstOctave = 2, kLastOctave = 7;  // 125 Hz to 4 kHz
constexpr std::uint64_t kSeeds = 4;

const audio::Bands& bands() {
    return audio::Bands::octaves();
}

/// A number per octave.
EnergyCoefficient per_octave(const audio::Spectrum& values) {
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t band = 0; band < bands().count(); ++band) {
        points.push_back({bands().nominal_hz()[band], values[band]});
    }
    return EnergyCoefficient(points);
}

/// Each material with the mean of its scattering in all bands.
Scene scene_that_scatters_alike(const std::string& file) {
    Scene scene = io::load_scene(test::source_file("scenes/" + file)).scene;
    for (Material& material : scene.materials) {
        const audio::Spectrum scattering = material.scattering.over(bands());
        const auto end = scattering.begin() + static_cast<std::ptrdiff_t>(bands().count());
        material.absorption = per_octave(material.absorption.over(bands()));
        material.scattering = EnergyCoefficient(std::accumulate(scattering.begin(), end, 0.0) /
                                                static_cast<double>(bands().count()));
    }
    return scene;
}

struct Rays {
    std::size_t count = 0;
    double length = 0.0;  ///< of the late energy, seconds
    std::uint64_t seed = 1;
};

/// All pairs, with late energy of the same rays whatever the materials.
std::vector<PairResult> full_run(const Scene& scene,
                                 const Rays& rays,
                                 bool report_materials,
                                 Executor& executor) {
    Simulator simulator(scene, {.specular_order = 3}, executor);
    std::vector<PairResult> pairs = simulator.run(executor);
    std::vector<geometry::Vec3> listeners;
    for (const Emitter& listener : scene.listeners) {
        listeners.push_back(scene.pose_at(listener, 0.0).position);
    }
    for (std::size_t source = 0; source < scene.sources.size(); ++source) {
        const Emitter& emitter = scene.sources[source];
        const LateEnergy late = trace_late_rays(simulator.ray_scene(),
                                                {scene.pose_at(emitter, 0.0), emitter.directivity},
                                                listeners,
                                                {.rays = rays.count,
                                                 .seed = rays.seed,
                                                 .length = rays.length,
                                                 .specular_order = 3,
                                                 .report_materials = report_materials},
                                                executor);
        for (std::size_t k = 0; k < listeners.size(); ++k) {
            PairResult& pair = pairs[source * listeners.size() + k];
            pair.late = late.listeners[k];
            pair.late.full_decay = true;
            if (report_materials) {
                pair.late_materials = late.materials[k];
            }
        }
    }
    return pairs;
}

std::vector<audio::RoomMetrics> metrics_of(const std::vector<PairResult>& pairs) {
    std::vector<audio::RoomMetrics> metrics;
    for (const PairResult& pair : pairs) {
        metrics.push_back(audio::energy_metrics(bands(), arrivals_of(pair), pair.late));
    }
    return metrics;
}

/// Steps of -log(1 - absorption) per band, in which energies are exponential functions and T30 is
/// nearly linear: large enough to move the lower end of T30's range by about half a decibel, as
/// T30 jumps from step to step of a decay, and at most to no absorption at all.
audio::Spectrum steps_for(const std::vector<PairSensitivity>& pairs,
                          std::size_t material,
                          const audio::Spectrum& absorption) {
    constexpr double kRelativeChange = 0.014;  // of T30: half of 35 dB
    constexpr double kMaxStep = 0.15;
    audio::Spectrum steps{};
    for (std::size_t band = 0; band < bands().count(); ++band) {
        steps[band] = std::min(kMaxStep, -0.9 * std::log(1.0 - absorption[band]));
        for (const PairSensitivity& pair : pairs) {
            const auto& derivative =
                pair.materials[material].derivatives.bands[band].reverberation_time_t30;
            if (derivative) {
                const double time = *pair.metrics.bands[band].reverberation_time_t30;
                steps[band] = std::min(
                    steps[band],
                    kRelativeChange * time / (std::abs(*derivative) * (1.0 - absorption[band])));
            }
        }
    }
    return steps;
}

/// A derivative and its difference, once per seed.
struct Samples {
    std::vector<double> derivatives{}, errors{}, differences{}, apart{};

    void add(double derivative, double error, double difference) {
        derivatives.push_back(derivative);
        errors.push_back(error);
        differences.push_back(difference);
        apart.push_back(derivative - difference);
    }
};

double mean(const std::vector<double>& numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0) /
           static_cast<double>(numbers.size());
}

using Comparisons = std::map<std::string, Samples>;  // by what is compared

/// Of one material, all bands of which change together; T30 and C80 of a band depend on it alone.
void compare_material(const Scene& scene,
                      const Rays& rays,
                      const std::vector<PairSensitivity>& pairs,
                      std::size_t material,
                      Executor& executor,
                      Comparisons& comparisons) {
    const audio::Spectrum absorption = scene.materials[material].absorption.over(bands());
    const audio::Spectrum steps = steps_for(pairs, material, absorption);
    const auto metrics_with = [&](double sign) {
        Scene changed = scene;
        audio::Spectrum values = absorption;
        for (std::size_t band = 0; band < bands().count(); ++band) {
            values[band] = 1.0 - (1.0 - absorption[band]) * std::exp(-sign * steps[band]);
        }
        changed.materials[material].absorption = per_octave(values);
        return metrics_of(full_run(changed, rays, false, executor));
    };
    const std::vector<audio::RoomMetrics> less = metrics_with(-1.0), more = metrics_with(1.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const MaterialSensitivity& found = pairs[i].materials[material];
        const std::string name = scene.materials[material].name + ", " +
                                 scene.listeners[pairs[i].listener].name + ", octave ";
        for (std::size_t band = kFirstOctave; band <= kLastOctave; ++band) {
            const audio::BandMetrics& derivatives = found.derivatives.bands[band];
            const audio::BandMetrics& errors = found.standard_errors.bands[band];
            const double change = 2.0 * steps[band] * (1.0 - absorption[band]);
            const auto rate = [&](const audio::RoomMetrics& metrics) {
                return 1.0 / metrics.bands[band].reverberation_time_t30.value();
            };
            const double time = pairs[i].metrics.bands[band].reverberation_time_t30.value();
            comparisons["T30, " + name + std::to_string(band)].add(
                derivatives.reverberation_time_t30.value(),
                errors.reverberation_time_t30.value(),
                -time * time * (rate(more[i]) - rate(less[i])) / change);
            comparisons["C80, " + name + std::to_string(band)].add(
                derivatives.clarity_c80_db.value(),
                errors.clarity_c80_db.value(),
                (*more[i].bands[band].clarity_c80_db - *less[i].bands[band].clarity_c80_db) /
                    change);
        }
        // In the direction of the change of all bands.
        double derivative = 0.0;
        for (std::size_t band = 0; band < bands().count(); ++band) {
            derivative += found.derivatives.speech_bands[band].value() * 2.0 * steps[band] *
                          (1.0 - absorption[band]);
        }
        const double relative_error = *found.standard_errors.speech_transmission_index /
                                      std::abs(found.derivatives.speech_transmission_index.value());
        comparisons["STI, " + name + "all"].add(
            derivative,
            relative_error * std::abs(derivative),
            *more[i].speech_transmission_index - *less[i].speech_transmission_index);
    }
}

Comparisons compare_with_full_runs(const std::string& file, Rays rays) {
    Executor executor(2);
    const Scene scene = scene_that_scatters_alike(file);
    Comparisons comparisons;
    for (rays.seed = 1; rays.seed <= kSeeds; ++rays.seed) {
        std::vector<PairSensitivity> pairs;
        for (const PairResult& pair : full_run(scene, rays, true, executor)) {
            pairs.push_back(pair_sensitivity(scene, pair));
        }
        for (std::size_t material = 0; material < scene.materials.size(); ++material) {
            compare_material(scene, rays, pairs, material, executor, comparisons);
        }
    }
    return comparisons;
}

/// Derivatives with a standard error below 5 % and differences as certain are within 5 %, all
/// others besides within that standard error and four of the difference. Returns how many of a
/// metric are of the first kind.
int expect_agreement(const Comparisons& comparisons, const std::string& metric) {
    constexpr double kMaxRelativeError = 0.05;
    int certain = 0;
    for (const auto& [what, samples] : comparisons) {
        if (!what.starts_with(metric)) {
            continue;
        }
        const double derivative = mean(samples.derivatives), difference = mean(samples.differences);
        const double error = mean(samples.errors) / std::sqrt(static_cast<double>(kSeeds));
        const double chance = 4.0 * standard_error_of_mean(samples.apart);
        const double tolerance = kMaxRelativeError * std::abs(difference);
        const bool is_certain =
            error < kMaxRelativeError * std::abs(derivative) && chance < tolerance;
        EXPECT_NEAR(derivative, difference, is_certain ? tolerance : tolerance + error + chance)
            << what;
        certain += is_certain ? 1 : 0;
    }
    return certain;
}

TEST(SlowSensitivity, IsTheDifferenceOfFullRunsOfTheClassroom) {
    const Comparisons found =
        compare_with_full_runs("classroom.gltf", {.count = 10000, .length = 1.5});
    EXPECT_EQ(found.size(), 9U * 3U * (6U + 6U + 1U));
    EXPECT_GE(expect_agreement(found, "T30"), 40);
    EXPECT_GE(expect_agreement(found, "C80"), 100);
    EXPECT_GE(expect_agreement(found, "STI"), 15);
}

TEST(SlowSensitivity, IsTheDifferenceOfFullRunsOfTheCoupledRooms) {
    const Comparisons found =
        compare_with_full_runs("coupled_rooms.gltf", {.count = 10000, .length = 6.5});
    EXPECT_EQ(found.size(), 5U * 2U * (6U + 6U + 1U));
    EXPECT_GE(expect_agreement(found, "T30"), 10);
    EXPECT_GE(expect_agreement(found, "C80"), 20);
    EXPECT_GE(expect_agreement(found, "STI"), 4);
}

}  // namespace
}  // namespace earshot::propagation
