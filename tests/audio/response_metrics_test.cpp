// SPDX-License-Identifier: MIT
#include "earshot/audio/response_metrics.h"

#include "earshot/base/digest.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <utility>

namespace earshot::audio {
namespace {

constexpr std::size_t kOnset = 2400;
constexpr double kSampleRate = 48000.0;

ImpulseResponse impulses(double length, const std::vector<std::pair<double, double>>& hits) {
    ImpulseResponse response{kSampleRate, std::vector<double>(std::size_t(length * kSampleRate))};
    for (const auto& [time, amplitude] : hits) {
        response.samples[std::size_t(std::lround(time * kSampleRate))] += amplitude;
    }
    return response;
}

// Noise whose energy falls by 60 dB in `time`, to 90 dB.
ImpulseResponse decaying_noise(double time, std::uint64_t seed) {
    const std::size_t size = kOnset + std::size_t(1.5 * time * kSampleRate);
    ImpulseResponse response{kSampleRate, std::vector<double>(size)};
    for (std::size_t n = kOnset; n < size; ++n) {
        const double along = static_cast<double>(n - kOnset) / kSampleRate;
        response.samples[n] =
            random_between(seed, 0, n, -1.0, 1.0) * math::pow10(-3.0 * along / time);
    }
    return response;
}

// Paths of a rigid-walled box up to an order, by the image sources of Allen and Berkley 1979.
std::vector<Arrival> box_arrivals(int order, double reflected_pressure) {
    const double size[3] = {8.0, 6.0, 3.5}, source[3] = {2.0, 1.5, 1.2},
                 listener[3] = {5.5, 4.0, 1.6};
    std::vector<Arrival> arrivals;
    for (int i = -order; i <= order; ++i) {
        for (int j = -order + std::abs(i); j <= order - std::abs(i); ++j) {
            const int left = order - std::abs(i) - std::abs(j);
            for (int k = -left; k <= left; ++k) {
                const int q[3] = {i, j, k};
                double squared = 0.0;
                for (int axis = 0; axis < 3; ++axis) {
                    const double image =
                        q[axis] * size[axis] +
                        (q[axis] % 2 == 0 ? source[axis] : size[axis] - source[axis]);
                    squared += (image - listener[axis]) * (image - listener[axis]);
                }
                const int bounces = std::abs(i) + std::abs(j) + std::abs(k);
                Arrival arrival;
                arrival.delay = std::sqrt(squared) / 343.0;
                arrival.pressure.fill(std::pow(reflected_pressure, bounces) / std::sqrt(squared));
                arrivals.push_back(arrival);
            }
        }
    }
    return arrivals;
}

/// A note of that metric and band whose text holds that of `wanted`.
bool has_note(const RoomMetrics& metrics, const MetricNote& wanted) {
    return std::any_of(metrics.notes.begin(), metrics.notes.end(), [&](const MetricNote& note) {
        return note.metric == wanted.metric && note.band_hz == wanted.band_hz &&
               note.text.find(wanted.text) != std::string::npos;
    });
}

// The published values are those of the ideal decay; a decay of noise in a band scatters about them
// as 1 / sqrt(bandwidth * time). The factors are four times the scatter seen over 20 seeds.
TEST(ResponseMetrics, OfDecayingNoiseAreThoseOfTheIdealDecay) {
    std::ifstream file(test::source_file("tests/data/exponential-decay-metrics.json"));
    ASSERT_TRUE(file) << "tests/data/exponential-decay-metrics.json is missing";
    const auto cases = nlohmann::json::parse(file).at("cases");
    ASSERT_EQ(cases.size(), 5U);
    const Bands& bands = Bands::octaves();
    for (const auto& ideal : cases) {
        const double time = ideal.at("T");
        const auto metrics = response_metrics(bands, decaying_noise(time, 1));
        for (std::size_t b = 4; b < bands.count(); ++b) {
            const BandMetrics& got = metrics.bands[b];
            const double bandwidth = bands.upper_edge_hz(b) - bands.lower_edge_hz(b);
            const double scatter = 1.0 / std::sqrt(bandwidth * time);
            // Energy before the limit falls within T / 14 (the decay's time constant) or 50 ms, and
            // four times the scatter of a level is 4 * 4.34 dB; of two levels, sqrt(2) more.
            const double early_scatter = 1.0 / std::sqrt(bandwidth * std::min(time / 14, 0.05));
            const auto label = "T " + std::to_string(time) + ", band " + std::to_string(b);
            ASSERT_TRUE(got.early_decay_time && got.reverberation_time_t20 &&
                        got.reverberation_time_t30 && got.clarity_c50_db && got.clarity_c80_db &&
                        got.definition_d50 && got.centre_time)
                << label;
            EXPECT_NEAR(*got.early_decay_time / time, 1.0, 6.5 * scatter) << label;
            EXPECT_NEAR(*got.reverberation_time_t20 / time, 1.0, 4.0 * scatter) << label;
            EXPECT_NEAR(*got.reverberation_time_t30 / time, 1.0, 2.5 * scatter) << label;
            EXPECT_NEAR(*got.clarity_c50_db, double(ideal.at("C50")), 24.0 * early_scatter)
                << label;
            EXPECT_NEAR(*got.clarity_c80_db, double(ideal.at("C80")), 24.0 * early_scatter)
                << label;
            EXPECT_NEAR(*got.definition_d50, double(ideal.at("D50")), 1.4 * early_scatter) << label;
            EXPECT_NEAR(*got.centre_time * 1000.0 / double(ideal.at("Ts_ms")), 1.0, 6.0 * scatter)
                << label;
        }
    }
}

// A tone at a band's centre has no scatter: the filter alone stands between it and the closed form.
TEST(ResponseMetrics, OfADecayingToneAreThoseOfTheIdealDecay) {
    const Bands& bands = Bands::octaves();
    constexpr double ideal_time = 1.0;
    for (const std::size_t band : {3U, 5U, 8U}) {
        ImpulseResponse response{kSampleRate, std::vector<double>(80000)};
        for (std::size_t n = kOnset; n < response.samples.size(); ++n) {
            const double along = static_cast<double>(n - kOnset) / kSampleRate;
            response.samples[n] = std::cos(2 * std::numbers::pi * bands.exact_hz()[band] * along) *
                                  std::pow(10.0, -3.0 * along / ideal_time);
        }
        const auto got = response_metrics(bands, response).bands[band];
        ASSERT_TRUE(got.early_decay_time && got.reverberation_time_t30 && got.clarity_c80_db);
        EXPECT_NEAR(*got.early_decay_time, ideal_time, 0.01) << band;
        EXPECT_NEAR(*got.reverberation_time_t20, ideal_time, 0.002) << band;
        EXPECT_NEAR(*got.reverberation_time_t30, ideal_time, 0.002) << band;
        EXPECT_NEAR(*got.clarity_c80_db, 3.0534098934089733, 0.05) << band;
        EXPECT_NEAR(*got.definition_d50, 0.49881276637272776, 0.005) << band;
        EXPECT_NEAR(*got.centre_time, 0.07238241365054198, 0.001) << band;
    }
}

TEST(ResponseMetrics, OfOneImpulseAreThoseOfTheFreeField) {
    const Bands& bands = Bands::octaves();
    const auto metrics = response_metrics(bands, impulses(0.5, {{0.1, 0.1}}));
    for (std::size_t b = 0; b < bands.count(); ++b) {
        const BandMetrics& got = metrics.bands[b];
        EXPECT_FALSE(got.early_decay_time || got.reverberation_time_t20 ||
                     got.reverberation_time_t30)
            << b;
        ASSERT_TRUE(got.definition_d50 && got.centre_time && got.strength_db) << b;
        // At 31.5 Hz the filter rings for more than 50 ms.
        EXPECT_NEAR(*got.definition_d50, 1.0, b == 0 ? 0.005 : 0.001);
        EXPECT_NEAR(*got.centre_time, 0.0, 1e-9);
        EXPECT_NEAR(*got.strength_db, 0.0, 1e-3);
        EXPECT_EQ(got.clarity_c80_db.has_value(), b < 2) << b;
    }
    EXPECT_TRUE(has_note(metrics, {"c80", 1000.0, "no energy after 80 ms"}));
    EXPECT_TRUE(has_note(metrics, {"t20", 31.5, "decay of "}));
}

TEST(ResponseMetrics, OfTwoImpulsesAreInClosedForm) {
    const Bands& bands = Bands::octaves();
    const auto metrics = response_metrics(bands, impulses(0.5, {{0.1, 0.2}, {0.2, 0.1}}));
    for (std::size_t b = 3; b < bands.count(); ++b) {
        const BandMetrics& got = metrics.bands[b];
        ASSERT_TRUE(got.clarity_c50_db && got.clarity_c80_db && got.centre_time) << b;
        EXPECT_NEAR(*got.clarity_c50_db, 10 * std::log10(4.0), 0.02) << b;
        EXPECT_NEAR(*got.clarity_c80_db, 10 * std::log10(4.0), 0.02) << b;
        EXPECT_NEAR(*got.definition_d50, 0.8, 0.001) << b;
        EXPECT_NEAR(*got.centre_time, 0.02, 1e-4) << b;
        EXPECT_NEAR(*got.strength_db, 10 * std::log10(5.0), 0.02) << b;
        EXPECT_FALSE(got.early_decay_time || got.reverberation_time_t20) << b;
    }
}

TEST(ResponseMetrics, StrengthOfTheDirectSoundAtTenMetresIsZero) {
    const Bands& bands = Bands::octaves();
    for (const double fraction : {0.0, 0.25, 0.5, 0.9}) {
        Arrival arrival;
        arrival.delay = (1400.0 + fraction) / kSampleRate;
        arrival.pressure.fill(0.1);
        const auto metrics = response_metrics(
            bands,
            assemble(bands, std::vector{arrival}, {.sample_rate = kSampleRate, .length = 0.2}));
        for (std::size_t b = 0; b < bands.count(); ++b) {
            EXPECT_NEAR(metrics.bands[b].strength_db.value(), 0.0, 0.1) << b << " " << fraction;
        }
    }
}

TEST(ResponseMetrics, KeepBandsApart) {
    const Bands& bands = Bands::octaves();
    Arrival arrival;
    arrival.delay = 0.02;
    arrival.pressure.fill(1e-4);
    arrival.pressure[6] = 0.1;
    const auto metrics = response_metrics(bands, assemble(bands, std::vector{arrival}));
    EXPECT_GT(metrics.bands[6].strength_db.value(), -12.0);
    EXPECT_LT(metrics.bands[3].strength_db.value(), -35.0);
    EXPECT_LT(metrics.bands[9].strength_db.value(), -35.0);
}

// T20 of this room is 1.64 s. Paths of a few reflections end after some 0.1 s, and a line through
// their curve would say 0.13 s.
TEST(ResponseMetrics, OfEarlyPathsAloneClaimNoReverberation) {
    const Bands& bands = Bands::octaves();
    for (int order = 0; order <= 6; ++order) {
        const auto arrivals = box_arrivals(order, std::sqrt(0.9));
        const auto metrics = response_metrics(bands, assemble(bands, arrivals));
        for (std::size_t b = 0; b < bands.count(); ++b) {
            EXPECT_FALSE(metrics.bands[b].early_decay_time) << order << ", band " << b;
            EXPECT_FALSE(metrics.bands[b].reverberation_time_t20) << order << ", band " << b;
            EXPECT_FALSE(metrics.bands[b].reverberation_time_t30) << order << ", band " << b;
        }
        if (order > 2) {
            EXPECT_TRUE(has_note(metrics, {"c80", {}, "ends before its decay does"})) << order;
        }
    }
}

// With absorption 0.7 the decay is over before the paths are: T20 of all images is 0.146 s.
TEST(ResponseMetrics, OfEnoughPathsClaimTheirReverberation) {
    const Bands& bands = Bands::octaves();
    const auto metrics = response_metrics(bands, assemble(bands, box_arrivals(14, std::sqrt(0.3))));
    for (std::size_t b = 5; b < bands.count(); ++b) {
        // Paths interfere in a band; their energies do not.
        EXPECT_NEAR(metrics.bands[b].reverberation_time_t20.value_or(0.0), 0.146, 0.03) << b;
    }
}

TEST(ResponseMetrics, OfSilenceAreEmptyWithOneNote) {
    for (const std::size_t size : {0U, 1U, 4800U}) {
        const auto metrics =
            response_metrics(Bands::octaves(), {kSampleRate, std::vector<double>(size, 0.0)});
        ASSERT_EQ(metrics.bands.size(), 10U);
        for (const BandMetrics& band : metrics.bands) {
            EXPECT_FALSE(band.strength_db || band.definition_d50 || band.early_decay_time);
        }
        EXPECT_EQ(metrics.notes, (std::vector<MetricNote>{{"all", {}, "the response is silent"}}));
    }
}

// Its squares underflow to 0.
TEST(ResponseMetrics, OfANearlySilentResponseAreEmpty) {
    const auto metrics = response_metrics(Bands::octaves(), impulses(0.2, {{0.05, 1e-200}}));
    EXPECT_FALSE(metrics.bands[5].strength_db);
    EXPECT_TRUE(has_note(metrics, {"all", 1000.0, "silent"}));
}

TEST(ResponseMetrics, NeedAResponsePastTheirLimit) {
    const auto metrics = response_metrics(Bands::octaves(), impulses(0.1, {{0.03, 1.0}}));
    EXPECT_TRUE(metrics.bands[5].definition_d50);
    EXPECT_FALSE(metrics.bands[5].strength_db || metrics.bands[5].centre_time);
    EXPECT_TRUE(has_note(metrics, {"ts", {}, "the response ends within 80 ms"}));
}

TEST(ResponseMetrics, LeaveOutBandsAboveHalfTheSampleRate) {
    ImpulseResponse response{8000.0, std::vector<double>(4000, 0.0)};
    response.samples[80] = 1.0;
    const auto metrics = response_metrics(Bands::octaves(), response);
    EXPECT_TRUE(metrics.bands[6].strength_db);
    EXPECT_FALSE(metrics.bands[7].strength_db);
    EXPECT_TRUE(has_note(metrics, {"all", 4000.0, "the band reaches past half the sample rate"}));
}

// Run again with CPU features masked (docs/determinism.md), this must not change.
TEST(ResponseMetrics, HaveTheSameBitsOnEveryMachine) {
    Digest digest;
    for (const BandMetrics& band :
         response_metrics(Bands::octaves(), decaying_noise(0.5, 9)).bands) {
        for (const auto& value : {band.early_decay_time,
                                  band.reverberation_time_t20,
                                  band.reverberation_time_t30,
                                  band.clarity_c50_db,
                                  band.clarity_c80_db,
                                  band.definition_d50,
                                  band.centre_time,
                                  band.strength_db}) {
            digest.add(value.value_or(-1.0));
        }
    }
    EXPECT_EQ(digest.value(), 5206223545343342989ULL);
}

// A measured response: two seconds, of which the decay is lost in steady noise.
ImpulseResponse with_noise(ImpulseResponse response, double level_db) {
    response.samples.resize(std::size_t(2.0 * kSampleRate), 0.0);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        response.samples[n] += random_between(99, 1, n, -1.0, 1.0) * math::pow10(level_db / 20.0);
    }
    return response;
}

TEST(ResponseMetrics, NoiseAtTheEndOfAMeasurementIsTakenOut) {
    const ImpulseResponse clean = decaying_noise(0.6, 5);
    const Bands& bands = Bands::octaves();
    const RoomMetrics expected = response_metrics(bands, clean);
    const RoomMetrics raw = response_metrics(bands, with_noise(clean, -50.0));
    const RoomMetrics found =
        response_metrics(bands, with_noise(clean, -50.0), {.ends_in_noise = true});
    for (std::size_t band = 4; band < bands.count() - 1; ++band) {
        ASSERT_TRUE(found.bands[band].reverberation_time_t20) << band;
        EXPECT_NEAR(*found.bands[band].reverberation_time_t20,
                    *expected.bands[band].reverberation_time_t20,
                    0.03)
            << band;
        EXPECT_NEAR(*found.bands[band].clarity_c80_db, *expected.bands[band].clarity_c80_db, 0.05);
        if (raw.bands[band].reverberation_time_t30 && found.bands[band].reverberation_time_t30) {
            const double truth = *expected.bands[band].reverberation_time_t30;
            EXPECT_LT(std::abs(*found.bands[band].reverberation_time_t30 - truth),
                      std::abs(*raw.bands[band].reverberation_time_t30 - truth) + 1e-9);
        }
    }
    ASSERT_TRUE(found.speech_transmission_index);
    EXPECT_NEAR(*found.speech_transmission_index, *expected.speech_transmission_index, 0.005);
}

TEST(ResponseMetrics, DecayTimesThatNoiseLeavesNoRoomForAreEmpty) {
    const RoomMetrics found = response_metrics(
        Bands::octaves(), with_noise(decaying_noise(0.6, 5), -27.0), {.ends_in_noise = true});
    for (std::size_t band = 4; band < 9; ++band) {
        EXPECT_TRUE(found.bands[band].early_decay_time) << band;
        EXPECT_FALSE(found.bands[band].reverberation_time_t20) << band;
        EXPECT_FALSE(found.bands[band].reverberation_time_t30) << band;
    }
    EXPECT_TRUE(has_note(found, {"t30", 1000.0, "noise "}));
    EXPECT_TRUE(has_note(found, {"t30", 1000.0, "45 dB needed"}));
}

TEST(ResponseMetrics, AResponseWithoutNoiseIsNotCut) {
    ImpulseResponse clean = decaying_noise(0.6, 6);
    const RoomMetrics plain = response_metrics(Bands::octaves(), clean);
    const RoomMetrics found = response_metrics(Bands::octaves(), clean, {.ends_in_noise = true});
    for (std::size_t band = 4; band < 9; ++band) {
        EXPECT_EQ(found.bands[band].reverberation_time_t30,
                  plain.bands[band].reverberation_time_t30);
    }
}

}  // namespace
}  // namespace earshot::audio
