// SPDX-License-Identifier: MIT
#include "earshot/audio/impulse_response.h"

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <span>

namespace earshot::audio {
namespace {

Arrival flat_arrival(double delay, double amplitude) {
    Arrival arrival;
    arrival.delay = delay;
    arrival.pressure.fill(amplitude);
    return arrival;
}

std::vector<Arrival> random_arrivals(std::size_t count, std::uint64_t seed) {
    std::vector<Arrival> arrivals(count);
    for (std::size_t i = 0; i < count; ++i) {
        arrivals[i].delay = random(seed, 0, i) * 0.2;
        for (std::size_t b = 0; b < kMaxBands; ++b) {
            arrivals[i].pressure[b] = random_between(seed, b + 1, i, 0.01, 1.0);
        }
    }
    return arrivals;
}

std::complex<double> transform_at(const ImpulseResponse& response, double frequency_hz) {
    std::complex<double> sum = 0.0;
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        const double turns = std::fmod(static_cast<double>(n) * frequency_hz, response.sample_rate);
        sum +=
            std::polar(response.samples[n], -2 * std::numbers::pi * turns / response.sample_rate);
    }
    return sum;
}

std::uint64_t digest_of(const ImpulseResponse& response) {
    Digest digest;
    for (const double sample : response.samples) {
        digest.add(sample);
    }
    return digest.value();
}

TEST(Assemble, PutsAFlatArrivalOnAWholeSampleIntoThatSampleAlone) {
    const std::vector<Arrival> arrivals{flat_arrival(0.01, 0.25)};
    const auto response = assemble(Bands::octaves(), arrivals);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        EXPECT_EQ(response.samples[n], n == 480 ? 0.25 : 0.0) << n;
    }
}

TEST(Assemble, KeepsAmplitudeAndDelayOfAFlatArrivalBetweenSamples) {
    for (const double sample_rate : {8000.0, 44100.0, 48000.0, 192000.0}) {
        const double delay = 1000.37 / sample_rate;
        const std::vector<Arrival> arrivals{flat_arrival(delay, 0.5)};
        const auto response =
            assemble(Bands::octaves(), arrivals, {.sample_rate = sample_rate, .length = 0.0});
        EXPECT_NEAR(transform_at(response, 0.0).real(), 0.5, 1e-12);
        for (const double part : {0.01, 0.1, 0.3, 0.46}) {
            const double frequency = part * sample_rate;
            const auto expected =
                std::polar(0.5, -2 * std::numbers::pi * std::fmod(frequency * delay, 1.0));
            EXPECT_LT(std::abs(transform_at(response, frequency) - expected), 1.5e-5)
                << sample_rate << " Hz, at " << frequency;
        }
    }
}

TEST(Assemble, HasNothingBeforeTheArrivalButItsInterpolation) {
    const std::vector<Arrival> arrivals{flat_arrival(1000.5 / 48000.0, 1.0)};
    const auto response = assemble(Bands::octaves(), arrivals);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        if (n + 63 < 1000 || n > 1064) {
            EXPECT_EQ(response.samples[n], 0.0) << n;
        }
    }
}

// A source so close that an impulse has no room for its ringing (headset microphones) still has
// 1 / r at all frequencies.
TEST(Assemble, KeepsTheLevelOfCloseSources) {
    for (const double metres : {0.0107, 0.02, 0.025, 0.04, 0.05, 0.075, 0.1, 0.3}) {
        const double delay = metres / 343.2;
        const std::vector<Arrival> flat{flat_arrival(delay, 1.0 / metres)};
        std::vector<Arrival> dull = flat;
        dull[0].pressure[9] *= 0.5;  // 16 kHz
        const auto flat_response = assemble(Bands::octaves(), flat);
        const auto dull_response = assemble(Bands::octaves(), dull);
        for (const double hz : {40.0, 125.0, 1000.0, 4000.0, 7900.0, 16000.0, 21600.0}) {
            const auto value = transform_at(flat_response, hz);
            EXPECT_NEAR(20.0 * std::log10(std::abs(value) * metres), 0.0, 0.01) << metres << hz;
            const double expected = hz > 8000.0 ? 0.5 : 1.0;
            const double level = std::abs(transform_at(dull_response, hz)) * metres / expected;
            EXPECT_NEAR(20.0 * std::log10(level), 0.0, 0.1) << metres << " m, " << hz << " Hz";
        }
        const double turn = 2.0 * std::numbers::pi * 500.0;
        EXPECT_NEAR(-std::arg(transform_at(flat_response, 500.0)) / turn, delay, 1e-8) << metres;
    }
}

TEST(Assemble, PassesThroughTheBandPressuresAtTheBandCentres) {
    const Bands& bands = Bands::octaves();
    Arrival arrival;
    arrival.delay = 0.0503;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        for (std::size_t b = 0; b < bands.count(); ++b) {
            arrival.pressure[b] = std::pow(random_between(seed, 0, b, 0.5, 1.0), 3.0);
        }
        const auto response = assemble(bands, std::vector{arrival});
        for (std::size_t b = 0; b < bands.count(); ++b) {
            const double magnitude = std::abs(transform_at(response, bands.exact_hz()[b]));
            const double error_db = 20 * std::abs(std::log10(magnitude / arrival.pressure[b]));
            // The lowest bands have few bins per octave; from 125 Hz up the filter is exact enough
            // to be called so.
            EXPECT_LT(error_db, b < 2 ? 0.5 : 0.25) << "seed " << seed << ", band " << b;
        }
    }
}

TEST(Assemble, IsLinearInTheArrivals) {
    const auto arrivals = random_arrivals(20, 3);
    const auto all = assemble(Bands::octaves(), arrivals, {.sample_rate = 48000.0, .length = 0.4});
    std::vector<double> sum(all.samples.size(), 0.0);
    for (const Arrival& arrival : arrivals) {
        const auto one = assemble(
            Bands::octaves(), std::vector{arrival}, {.sample_rate = 48000.0, .length = 0.4});
        for (std::size_t n = 0; n < sum.size(); ++n) {
            sum[n] += one.samples[n];
        }
    }
    for (std::size_t n = 0; n < sum.size(); ++n) {
        ASSERT_NEAR(all.samples[n], sum[n], 1e-13) << n;
    }
}

TEST(Assemble, GivesTheSameBitsForAnyNumberOfThreads) {
    const auto arrivals = random_arrivals(150, 5);
    const Assembler assembler(Bands::octaves());
    const auto serial = assembler.assemble(arrivals);
    for (const int threads : {2, 3, 8}) {
        Executor executor(threads);
        EXPECT_EQ(digest_of(assembler.assemble(arrivals, 0.0, executor)), digest_of(serial));
    }
}

// Run again with CPU features masked (docs/determinism.md), this must not change.
TEST(Assemble, HasTheSameBitsOnEveryMachine) {
    EXPECT_EQ(digest_of(assemble(Bands::octaves(), random_arrivals(30, 1))),
              4966047010830343853ULL);
    EXPECT_EQ(digest_of(assemble(Bands::third_octaves(),
                                 random_arrivals(5, 2),
                                 {.sample_rate = 44100.0, .length = 0.0})),
              15294924631104889814ULL);
}

TEST(Assemble, AnswersSilenceWithZeros) {
    const auto by_default = assemble(Bands::octaves(), {});
    EXPECT_EQ(by_default.samples, std::vector<double>(4800, 0.0));
    const auto asked = assemble(Bands::octaves(), {}, {.sample_rate = 8000.0, .length = 0.25});
    EXPECT_EQ(asked.samples, std::vector<double>(2000, 0.0));
    EXPECT_EQ(asked.sample_rate, 8000.0);
    const std::vector<Arrival> nothing_heard{flat_arrival(3.0, 0.0)};
    EXPECT_EQ(assemble(Bands::octaves(), nothing_heard).samples, by_default.samples);
    const auto short_one = assemble(Bands::octaves(), {}, {.sample_rate = 8000.0, .length = 1e-9});
    EXPECT_EQ(short_one.samples.size(), 1U);
}

TEST(Assemble, LeavesOutArrivalsPastTheLength) {
    const std::vector<Arrival> arrivals{flat_arrival(0.01, 1.0), flat_arrival(1e9, 1.0)};
    const auto response =
        assemble(Bands::octaves(), arrivals, {.sample_rate = 48000.0, .length = 0.02});
    ASSERT_EQ(response.samples.size(), 960U);
    EXPECT_EQ(response.samples[480], 1.0);
    EXPECT_EQ(response.samples[959], 0.0);
}

// Half a sample of delay: the allpass filter (a + z^-1) / (1 + a z^-1) with a = (1 - d) / (1 + d).
TEST(Assemble, BeginsWithAnArrivalThatHasNoRoomForItsRinging) {
    const std::vector<Arrival> arrivals{flat_arrival(0.5 / 48000.0, 1.0)};
    const auto response = assemble(Bands::octaves(), arrivals);
    EXPECT_NEAR(response.samples[0], 1.0 / 3.0, 1e-12);
    for (int n = 1; n < 20; ++n) {
        EXPECT_NEAR(response.samples[static_cast<std::size_t>(n)],
                    8.0 / 9.0 * std::pow(-1.0 / 3.0, n - 1),
                    1e-12);
    }
}

TEST(Assemble, HoldsTheLastArrivalAndItsRinging) {
    Arrival arrival = flat_arrival(0.5, 1.0);
    arrival.pressure[0] = 0.1;
    const auto response = assemble(Bands::octaves(), std::vector{arrival});
    EXPECT_EQ(response.samples.size(), 24000U + 4096U);
    // The lowest band still rings where the filter ends.
    EXPECT_LT(std::abs(response.samples.back()), 1.25e-5);
}

TEST(Assemble, RefusesWhatItCannotDo) {
    const Bands& bands = Bands::octaves();
    const auto with = [&](double sample_rate, double length) {
        return assemble(bands, {}, {.sample_rate = sample_rate, .length = length});
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double sample_rate : {0.0, -1.0, 999.0, 768001.0, nan}) {
        EXPECT_THROW(with(sample_rate, 0.0), Error) << sample_rate;
    }
    for (const double length : {-1.0, 1e12, 44740.0, nan}) {
        EXPECT_THROW(with(48000.0, length), Error) << length;
    }
    EXPECT_THROW(assemble(bands, std::vector{flat_arrival(1e9, 1.0)}), Error);
    EXPECT_THROW(assemble(bands, std::vector{flat_arrival(-1.0, 1.0)}), Error);
    EXPECT_THROW(assemble(bands, std::vector{flat_arrival(1.0, nan)}), Error);
}

}  // namespace
}  // namespace earshot::audio
