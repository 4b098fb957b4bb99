// SPDX-License-Identifier: MIT
#include "earshot/audio/late_noise.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/response_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace earshot::audio {
namespace {

constexpr double kSampleRate = 48000.0;
const FilterCache kCache;

/// Energies that decay by 60 dB in `time` seconds, a share per band.
EnergyHistogram decay(double time, double length, const Spectrum& shares) {
    EnergyHistogram histogram{.bin = 1e-3, .energy = {}, .error = {}};
    for (int n = 0; n < std::lround(length / histogram.bin); ++n) {
        const double t = n * histogram.bin;
        Spectrum energy{};
        for (std::size_t band = 0; band < kMaxBands; ++band) {
            energy[band] = shares[band] * std::exp(-13.815510557964274 * t / time);
        }
        histogram.energy.push_back(energy);
    }
    return histogram;
}

Spectrum flat(double value) {
    Spectrum spectrum;
    spectrum.fill(value);
    return spectrum;
}

TEST(LateNoise, HasTheEnergyOfAnArrivalOfTheSamePressure) {
    const Bands& bands = Bands::octaves();
    const EnergyHistogram histogram = decay(1.0, 1.5, flat(1e-4));
    const double pressure_squared = std::accumulate(
        histogram.energy.begin(), histogram.energy.end(), 0.0, [](double sum, const Spectrum& bin) {
            return sum + bin[0];
        });
    const auto samples = late_noise(bands, histogram, kSampleRate, 1);
    ASSERT_EQ(samples.size(), 72000U);
    const BandEnergy energy(bands, samples, kSampleRate, kCache);
    for (std::size_t band = 2; band + 1 < bands.count(); ++band) {
        const auto squared = energy.squared(band);
        const double sum = std::accumulate(squared.begin(), squared.end(), 0.0);
        const double expected = pressure_squared * energy.of_unit_impulse(band);
        // Chance: 1 / sqrt(bandwidth * time), times three.
        const double bandwidth = bands.upper_edge_hz(band) - bands.lower_edge_hz(band);
        EXPECT_NEAR(sum / expected, 1.0, 3.0 / std::sqrt(0.14 * bandwidth)) << band;
    }
}

TEST(LateNoise, DecaysAsTheHistogramDoes) {
    const auto samples = late_noise(Bands::octaves(), decay(0.8, 1.6, flat(1e-4)), kSampleRate, 2);
    const RoomMetrics metrics = response_metrics(Bands::octaves(), {kSampleRate, samples});
    for (std::size_t band = 4; band < 9; ++band) {
        ASSERT_TRUE(metrics.bands[band].reverberation_time_t30) << band;
        EXPECT_NEAR(*metrics.bands[band].reverberation_time_t30, 0.8, 0.05) << band;
    }
}

TEST(LateNoise, KeepsBandsApart) {
    Spectrum shares{};
    shares[5] = 1e-4;  // 1 kHz alone
    const auto samples = late_noise(Bands::octaves(), decay(1.0, 0.5, shares), kSampleRate, 3);
    const BandEnergy energy(Bands::octaves(), samples, kSampleRate, kCache);
    const auto total = [&](std::size_t band) {
        const auto squared = energy.squared(band);
        return std::accumulate(squared.begin(), squared.end(), 0.0) / energy.of_unit_impulse(band);
    };
    EXPECT_LT(total(3), 1e-3 * total(5));
    EXPECT_LT(total(7), 1e-3 * total(5));
}

TEST(LateNoise, OfNothingIsSilence) {
    EXPECT_TRUE(late_noise(Bands::octaves(), {}, kSampleRate, 1).empty());
    EnergyHistogram silent{.bin = 1e-3, .energy = std::vector<Spectrum>(10), .error = {}};
    for (const double sample : late_noise(Bands::octaves(), silent, kSampleRate, 1)) {
        EXPECT_EQ(sample, 0.0);
    }
}

}  // namespace
}  // namespace earshot::audio
