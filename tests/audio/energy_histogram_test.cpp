// SPDX-License-Identifier: MIT
#include "earshot/audio/energy_histogram.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/late_noise.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace earshot::audio {
namespace {

TEST(DirectionParts, AreEquallyLargeAndRoundTheirMiddles) {
    std::array<int, kDirectionParts> count{};
    constexpr int kPoints = 100000;
    for (std::uint64_t i = 0; i < kPoints; ++i) {
        const double z = random_between(1, 0, i, -1.0, 1.0);
        const double angle = random_between(1, 1, i, 0.0, 6.283185307179586);
        const double r = std::sqrt(1.0 - z * z);
        const std::array<double, 3> direction{r * std::cos(angle), r * std::sin(angle), z};
        const std::size_t part = direction_part(direction);
        ASSERT_LT(part, kDirectionParts);
        ++count[part];
        const auto middle = middle_of_part(part);
        EXPECT_GT(std::inner_product(middle.begin(), middle.end(), direction.begin(), 0.0), 0.8);
    }
    for (std::size_t part = 0; part < kDirectionParts; ++part) {
        EXPECT_EQ(direction_part(middle_of_part(part)), part);
        EXPECT_NEAR(count[part] * kDirectionParts / double{kPoints}, 1.0, 0.08);
    }
}

/// A decay whose energy comes from the front in the first span and from the left afterwards.
EnergyHistogram turning_decay() {
    EnergyHistogram histogram;
    histogram.energy.resize(200);
    histogram.directions.resize(10);
    for (std::size_t n = 0; n < histogram.energy.size(); ++n) {
        histogram.energy[n].fill(std::exp(-0.05 * static_cast<double>(n)));
    }
    for (std::size_t span = 0; span < histogram.directions.size(); ++span) {
        histogram
            .directions[span][direction_part(span == 0 ? std::array<double, 3>{1.0, 0.1, 0.1}
                                                       : std::array<double, 3>{0.1, 1.0, 0.1})]
            .fill(7.0);
    }
    return histogram;
}

TEST(EnergyFrom, SharesTheEnergyOutAmongTheParts) {
    const EnergyHistogram histogram = turning_decay();
    const auto front = energy_from(histogram, direction_part({1.0, 0.1, 0.1}));
    const auto left = energy_from(histogram, direction_part({0.1, 1.0, 0.1}));
    for (std::size_t n = 0; n < 200; ++n) {
        EXPECT_EQ(front.energy[n][3], n < kBinsPerSpan ? histogram.energy[n][3] : 0.0);
        EXPECT_EQ(left.energy[n][3], n < kBinsPerSpan ? 0.0 : histogram.energy[n][3]);
    }
}

double energy(const std::vector<double>& signal, std::size_t from, std::size_t to) {
    double sum = 0.0;
    for (std::size_t n = from; n < to; ++n) {
        sum += signal[n] * signal[n];
    }
    return sum;
}

TEST(AmbisonicLateNoise, ComesFromWhereTheEnergyDoes) {
    const auto channels = ambisonic_late_noise(Bands::octaves(), turning_decay(), 48000.0, 1, 1);
    ASSERT_EQ(channels.size(), 4U);
    // W, Y (left), Z (up), X (front); the filters smear the border at 20 ms.
    EXPECT_GT(energy(channels[3], 0, 480), 4.0 * energy(channels[1], 0, 480));
    EXPECT_GT(energy(channels[1], 1920, 4800), 4.0 * energy(channels[3], 1920, 4800));
    const double all = energy(channels[0], 1920, 4800);
    EXPECT_NEAR(energy(channels[1], 1920, 4800) / all, 1.0 / (1.0 + 2.0 * 0.1716), 0.05);
    const auto mono = late_noise(Bands::octaves(), turning_decay(), 48000.0, 1);
    EXPECT_NEAR(energy(mono, 0, mono.size()) / energy(channels[0], 0, mono.size()), 1.0, 0.3);
}

TEST(BinauralLateNoise, IsLouderInTheEarWhereItComesFrom) {
    HrirSet head;
    head.directions = {{{0.0, 1.0, 0.0}, {1.0}, {0.25}}, {{0.0, -1.0, 0.0}, {0.25}, {1.0}}};
    const auto ears =
        binaural_late_noise(Bands::octaves(), turning_decay(), HrirInterpolator(head), 1);
    EXPECT_NEAR(energy(ears[0], 2400, 9600) / energy(ears[1], 2400, 9600), 16.0, 0.1);
}

TEST(LateNoise, SparseReflectionsBringTheSameEnergy) {
    EnergyHistogram histogram;
    histogram.energy.assign(400, {});
    for (Spectrum& bin : histogram.energy) {
        bin.fill(1e-3);
    }
    const auto dense = late_noise(Bands::octaves(), histogram, 48000.0, 3);
    histogram.reflection_growth = 4.0 * 3.14159 * 343.0 * 343.0 * 343.0 / 20000.0;
    const auto sparse = late_noise(Bands::octaves(), histogram, 48000.0, 3);
    EXPECT_NEAR(energy(sparse, 4800, 19200) / energy(dense, 4800, 19200), 1.0, 0.1);
    // Until 30 ms there are 0.2 reflections.
    EXPECT_LT(energy(sparse, 0, 1440), 0.7 * energy(dense, 0, 1440));
}

TEST(EnergyMetrics, AreThoseOfAnIdealDecay) {
    EnergyHistogram histogram;
    histogram.full_decay = true;
    for (int n = 0; n < 1500; ++n) {
        histogram.energy.emplace_back().fill(1e-3 * std::exp(-13.815510557964274 * n * 1e-3));
    }
    const RoomMetrics metrics = energy_metrics(Bands::octaves(), {}, histogram);
    const BandMetrics& band = metrics.bands[5];
    EXPECT_NEAR(*band.early_decay_time, 1.0, 0.005);
    EXPECT_NEAR(*band.reverberation_time_t30, 1.0, 0.005);
    // 10 lg(exp(13.8155 * 0.08) - 1)
    EXPECT_NEAR(*band.clarity_c80_db, 10.0 * std::log10(std::exp(1.10524) - 1.0), 0.05);
    EXPECT_NEAR(*band.centre_time, 1.0 / 13.8155, 0.001);
    EXPECT_NEAR(*metrics.speech_transmission_index, 0.604, 0.02);
    EXPECT_NEAR(*schroeder_frequency_hz(Bands::octaves(), metrics, 200.0), 141.4, 0.5);
    EXPECT_FALSE(energy_metrics(Bands::octaves(), {}, {}).notes.empty());
}

}  // namespace
}  // namespace earshot::audio
