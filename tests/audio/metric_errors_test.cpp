// SPDX-License-Identifier: MIT
// Standard errors of expected metrics, against the spread of many experiments whose replicates are
// drawn independently.
#include "earshot/audio/energy_metrics.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace earshot::audio {
namespace {

constexpr std::size_t kBins = 600;
constexpr std::size_t kReplicates = 24;

const Bands& bands() {
    return Bands::octaves();
}

/// Late energy of an experiment, its replicates and the direct sound.
struct Experiment {
    std::vector<Arrival> arrivals;
    EnergyHistogram late{.full_decay = true};
    HistogramReplicates replicates;

    RoomMetrics metrics(const Bands& of = bands()) const {
        return energy_metrics(of, arrivals, late, {.replicates = &replicates});
    }
};

/// `factor(replicate, time, band)` times a decay of 60 dB in 0.4 s, in intervals of 4 bins.
template <class Factor>
Experiment experiment(const Factor& factor) {
    constexpr std::size_t kInterval = 4;
    Experiment result;
    result.arrivals.push_back({.delay = 0.01});
    result.arrivals.back().pressure.fill(0.15);
    result.late.energy.resize(kBins);
    result.late.error.resize(kBins);
    for (std::size_t bin = 0; bin <= kBins; bin += kInterval) {
        result.replicates.first_bin.push_back(bin);
    }
    for (std::size_t r = 0; r < kReplicates; ++r) {
        auto& energy = result.replicates.energy.emplace_back(kBins / kInterval);
        for (std::size_t n = 0; n < kBins; ++n) {
            const double time = 1e-3 * (static_cast<double>(n) + 0.5);
            const double decay = n < 15 ? 0.0 : 1e-3 * std::pow(10.0, -6.0 * time / 0.4);
            for (std::size_t band = 0; band < kMaxBands; ++band) {
                const double share = decay * factor(r, time, band);
                energy[n / kInterval][band] += share;
                result.late.energy[n][band] += share / kReplicates;
            }
        }
    }
    return result;
}

/// Independent of each other, uniform, mean 0, variance 1.
double deviate(std::uint64_t seed, std::size_t replicate, std::size_t band, std::size_t what) {
    return std::sqrt(12.0) *
           (random(seed, 100 * band + what, static_cast<std::uint64_t>(replicate)) - 0.5);
}

/// Level, decay time and single intervals of every replicate and band deviate.
Experiment noisy_experiment(std::uint64_t seed) {
    return experiment([&](std::size_t r, double time, std::size_t band) {
        const auto interval = static_cast<std::size_t>(time / 0.004);
        return (1.0 + 0.05 * deviate(seed, r, band, 0)) *
               std::exp(0.5 * time * deviate(seed, r, band, 1)) *
               (1.0 + 0.2 * deviate(seed, r, band, 2 + interval % 90));
    });
}

TEST(MetricErrors, AreTheSpreadOfTheMetricsOverExperiments) {
    constexpr std::size_t kExperiments = 40;
    std::vector<RoomMetrics> found;
    for (std::uint64_t seed = 0; seed < kExperiments; ++seed) {
        found.push_back(noisy_experiment(seed).metrics());
    }
    // Root mean squares over experiments (and bands, which are independent).
    const auto ratio = [&](const auto& values, const auto& errors) {
        double variance = 0.0, claimed = 0.0, mean = 0.0;
        for (const RoomMetrics& metrics : found) {
            mean += values(metrics).value() / kExperiments;
        }
        for (const RoomMetrics& metrics : found) {
            variance += std::pow(values(metrics).value() - mean, 2) / (kExperiments - 1.0);
            claimed += std::pow(errors(metrics).value(), 2) / kExperiments;
        }
        return std::array{variance, claimed};
    };
    for (const BandMetricKind& kind : kBandMetricKinds) {
        double variance = 0.0, claimed = 0.0;
        for (std::size_t band = 0; band < bands().count(); ++band) {
            const auto of_band = ratio(
                [&](const RoomMetrics& m) { return m.bands[band].*kind.value; },
                [&](const RoomMetrics& m) { return m.standard_error.bands[band].*kind.value; });
            variance += of_band[0];
            claimed += of_band[1];
        }
        // The spread of 400 values is known within 3.5 %.
        EXPECT_NEAR(std::sqrt(variance / claimed), 1.0, 0.12) << kind.key;
        const auto mid =
            ratio([&](const RoomMetrics& m) { return m.mid.*kind.value; },
                  [&](const RoomMetrics& m) { return m.standard_error.mid.*kind.value; });
        EXPECT_NEAR(std::sqrt(mid[0] / mid[1]), 1.0, 0.4) << kind.key;
    }
    const auto sti =
        ratio([](const RoomMetrics& m) { return m.speech_transmission_index; },
              [](const RoomMetrics& m) { return m.standard_error.speech_transmission_index; });
    EXPECT_NEAR(std::sqrt(sti[0] / sti[1]), 1.0, 0.4);
}

// Replicates that differ by a factor: the late energy's mean has the relative standard error
// sd / sqrt(B), and all metrics follow from the ratio of direct and late energy.
TEST(MetricErrors, OfALevelAreThoseOfTheDerivatives) {
    const auto factor = [](std::size_t r, double, std::size_t) {
        return 1.0 + 0.02 * (r % 2 == 0 ? 1.0 : -1.0);
    };
    const Experiment given = experiment(factor);
    const RoomMetrics metrics = given.metrics();
    double late = 0.0, late_after_50 = 0.0;
    for (std::size_t n = 0; n < kBins; ++n) {
        late += given.late.energy[n][5];
        late_after_50 += n >= 60 ? given.late.energy[n][5] : 0.0;
    }
    const double all = late + 0.15 * 0.15;
    const double error = 0.02 / std::sqrt(kReplicates - 1.0);
    const BandMetrics& errors = metrics.standard_error.bands[5];
    EXPECT_NEAR(*errors.strength_db, 10.0 / std::log(10.0) * late / all * error, 1e-5);
    const double d50_error = late_after_50 / all * (1.0 - late / all) * error;
    EXPECT_NEAR(*errors.definition_d50, d50_error, 1e-6);
    EXPECT_NEAR(*errors.clarity_c50_db,
                10.0 / std::log(10.0) * d50_error /
                    (*metrics.bands[5].definition_d50 * (1.0 - *metrics.bands[5].definition_d50)),
                1e-4);
    // All bands share the rays: their mean is no more certain.
    EXPECT_NEAR(*metrics.standard_error.mid.strength_db, *errors.strength_db, 1e-12);
}

TEST(MetricErrors, OfIndependentBandsPartlyCancelInTheirMean) {
    const RoomMetrics metrics = noisy_experiment(7).metrics();
    const auto error = [&](std::size_t band) {
        return metrics.standard_error.bands[band].strength_db.value();
    };
    EXPECT_NEAR(metrics.standard_error.mid.strength_db.value(),
                0.5 * std::hypot(error(4), error(5)),
                0.25 * error(5));
}

TEST(MetricErrors, WithholdWhatIsLessCertainThanADifferenceThatIsHeard) {
    const RoomMetrics metrics =
        experiment([](std::size_t r, double time, std::size_t band) {
            return std::exp((band == 5 ? 8.0 : 0.1) * time * deviate(3, r, band, 0));
        }).metrics();
    const std::optional<double> error = metrics.standard_error.bands[5].reverberation_time_t30;
    ASSERT_TRUE(error);
    EXPECT_GT(2.0 * *error, 0.05 * 0.4);
    EXPECT_FALSE(metrics.bands[5].reverberation_time_t30);
    EXPECT_FALSE(metrics.mid.reverberation_time_t30);
    EXPECT_TRUE(metrics.bands[4].reverberation_time_t30);
    EXPECT_LT(2.0 * metrics.standard_error.bands[4].reverberation_time_t30.value(), 0.05 * 0.4);
    const auto note_of = [&](const std::string& metric, std::optional<double> band_hz) {
        return std::find_if(
            metrics.notes.begin(), metrics.notes.end(), [&](const MetricNote& note) {
                return note.metric == metric && note.band_hz == band_hz;
            });
    };
    const auto note = note_of("t30", 1000.0);
    ASSERT_NE(note, metrics.notes.end());
    EXPECT_EQ(note->text.find("standard error 0.0"), 0U) << note->text;
    EXPECT_NE(note->text.find("more rays"), std::string::npos);
    EXPECT_NE(note_of("t30_mid", {}), metrics.notes.end());
    EXPECT_EQ(note_of("t30", 500.0), metrics.notes.end());
}

// Where all bands receive alike, thirds and octaves have one index and one error of it.
TEST(MetricErrors, OfThirdsAreThoseOfOctavesWhereBandsAreAlike) {
    const Experiment given = experiment([](std::size_t r, double time, std::size_t) {
        return std::exp(0.5 * time * deviate(5, r, 0, 1)) * (1.0 + 0.1 * deviate(5, r, 0, 0));
    });
    const RoomMetrics octaves = given.metrics();
    const RoomMetrics thirds = given.metrics(Bands::third_octaves());
    EXPECT_NEAR(
        thirds.speech_transmission_index.value(), octaves.speech_transmission_index.value(), 1e-9);
    EXPECT_NEAR(thirds.standard_error.speech_transmission_index.value() /
                    octaves.standard_error.speech_transmission_index.value(),
                1.0,
                1e-6);
    EXPECT_NEAR(thirds.standard_error.mid.reverberation_time_t30.value() /
                    octaves.standard_error.mid.reverberation_time_t30.value(),
                1.0,
                1e-6);
}

TEST(MetricErrors, NeedReplicates) {
    const Experiment given = noisy_experiment(1);
    const RoomMetrics without = energy_metrics(bands(), given.arrivals, given.late);
    EXPECT_TRUE(without.bands[5].strength_db);
    ASSERT_EQ(without.standard_error.bands.size(), bands().count());
    EXPECT_FALSE(without.standard_error.bands[5].strength_db);
    EXPECT_FALSE(without.standard_error.speech_transmission_index);
    // Values do not depend on the replicates.
    EXPECT_EQ(without.bands[5].early_decay_time, given.metrics().bands[5].early_decay_time);
}

}  // namespace
}  // namespace earshot::audio
