// SPDX-License-Identifier: MIT
#include "earshot/audio/spatial_metrics.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::audio {
namespace {

constexpr double kSampleRate = 48000.0;

ImpulseResponse noise(std::uint64_t stream, std::size_t size) {
    ImpulseResponse response{kSampleRate, std::vector<double>(size)};
    for (std::size_t n = 0; n < size; ++n) {
        response.samples[n] = random_between(5, stream, n, -1.0, 1.0);
    }
    return response;
}

// Reflections of amplitude a_i at angles from the median plane: LF is the sum of (a sin)^2 of those
// in 5 ... 80 ms over the sum of a^2 until 80 ms. One lies before 5 ms, one after 80 ms. They stand
// 10 ms and more apart and from the limits, which is far longer than the octaves from 2 kHz up
// ring.
TEST(LateralMetrics, OfSingleReflectionsAreTheClosedForm) {
    ImpulseResponse pressure{kSampleRate, std::vector<double>(9600)};
    ImpulseResponse eight = pressure;
    double lateral = 0.0;
    double whole = 0.0;
    const double hits[5][3] = {
        {0, 1.0, 0.4}, {20, 0.7, 1.0}, {40, 0.5, -0.8}, {60, 0.4, 0.1}, {110, 0.9, 0.9}};
    for (const auto& [time_ms, amplitude, sine] : hits) {
        const auto n = static_cast<std::size_t>(480 + 48 * time_ms);
        pressure.samples[n] = amplitude;
        eight.samples[n] = amplitude * sine;
        lateral += time_ms >= 5 && time_ms < 80 ? amplitude * amplitude * sine * sine : 0.0;
        whole += time_ms < 80 ? amplitude * amplitude : 0.0;
    }
    const auto metrics = lateral_metrics(Bands::octaves(), pressure, eight);
    for (std::size_t band = 6; band < 10; ++band) {  // 2 kHz and up
        ASSERT_TRUE(metrics.lateral_fraction[band]) << band;
        EXPECT_NEAR(*metrics.lateral_fraction[band], lateral / whole, 0.002) << band;
    }
}

TEST(LateralMetrics, SayWhyThereAreNone) {
    const auto silent = lateral_metrics(Bands::octaves(),
                                        {kSampleRate, std::vector<double>(9600)},
                                        {kSampleRate, std::vector<double>(9600)});
    EXPECT_FALSE(silent.lateral_fraction[5]);
    EXPECT_EQ(silent.notes.size(), 1U);
    const auto brief = lateral_metrics(Bands::octaves(), noise(0, 1000), noise(0, 1000));
    EXPECT_FALSE(brief.lateral_fraction[5]);
    EXPECT_EQ(brief.notes.size(), 1U);
}

// Ears that hear s and -s half a millisecond later correlate fully; s and a mixture c s + sqrt(1 -
// c^2) t of unrelated noises correlate by c, within the scatter of 3 / sqrt(2 bandwidth time).
TEST(BinauralMetrics, OfNoisesAreTheirCorrelation) {
    const std::size_t size = 48000;
    const auto left = noise(1, size);
    const auto other = noise(2, size);
    auto late = left;
    auto mixed = left;
    for (std::size_t n = 0; n < size; ++n) {
        late.samples[n] = n < 24 ? 0.0 : -left.samples[n - 24];
        mixed.samples[n] = 0.6 * left.samples[n] + 0.8 * other.samples[n];
    }
    const Bands& bands = Bands::octaves();
    const auto full = binaural_metrics(bands, left, late);
    const auto part = binaural_metrics(bands, left, mixed);
    for (std::size_t band = 4; band < bands.count(); ++band) {
        const double bandwidth = bands.upper_edge_hz(band) - bands.lower_edge_hz(band);
        ASSERT_TRUE(full.iacc[band] && full.iacc_early[band] && part.iacc[band]) << band;
        EXPECT_NEAR(*full.iacc[band], 1.0, 0.005) << band;
        EXPECT_NEAR(*full.iacc_early[band], 1.0, 0.05) << band;
        EXPECT_NEAR(*part.iacc[band], 0.6, 3.0 / std::sqrt(2.0 * bandwidth)) << band;
        EXPECT_NEAR(*part.iacc_late[band], 0.6, 3.2 / std::sqrt(2.0 * bandwidth)) << band;
    }
}

TEST(BinauralMetrics, SayWhyThereAreNone) {
    const auto deaf = binaural_metrics(
        Bands::octaves(), noise(1, 9600), {kSampleRate, std::vector<double>(9600)});
    EXPECT_FALSE(deaf.iacc[5]);
    EXPECT_EQ(deaf.notes.size(), 1U);
}

}  // namespace
}  // namespace earshot::audio
