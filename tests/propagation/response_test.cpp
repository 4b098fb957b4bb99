// SPDX-License-Identifier: MIT
#include "earshot/propagation/response.h"

#include "earshot/audio/spatial.h"
#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace earshot::propagation {
namespace {

const audio::Bands& bands() {
    return audio::Bands::octaves();
}

Path path(double length, double pressure, const geometry::Vec3& arrival) {
    Path result{.length = length, .delay = length / 343.0, .arrival = arrival};
    std::fill_n(result.pressure.begin(), bands().count(), pressure);
    return result;
}

/// Direct sound from the front and a reflection from the left of a listener that looks along -Z.
PairResult early_pair() {
    PairResult pair{.source = 1, .listener = 2, .time = 0.5};
    pair.paths = {path(3.43, 0.25, {0.0, 0.0, 1.0}), path(6.86, -0.1, {1.0, 0.0, 0.0})};
    return pair;
}

/// The same with an exponential decay of 60 dB in 0.4 s from all directions, 0.5 s long.
PairResult whole_pair() {
    PairResult pair = early_pair();
    audio::EnergyHistogram& late = pair.late;
    late = {.bin = 1e-3, .full_decay = true};
    for (int n = 0; n < 500; ++n) {
        audio::Spectrum& energy = late.energy.emplace_back();
        std::fill_n(energy.begin(), bands().count(), 1e-5 * std::pow(10.0, -6.0 * n / 400.0));
        late.error.emplace_back();
    }
    late.directions.resize(500 / audio::kBinsPerSpan);
    for (std::size_t span = 0; span < late.directions.size(); ++span) {
        for (audio::Spectrum& part : late.directions[span]) {
            for (std::size_t n = 0; n < audio::kBinsPerSpan; ++n) {
                for (std::size_t band = 0; band < bands().count(); ++band) {
                    part[band] += late.energy[span * audio::kBinsPerSpan + n][band] /
                                  static_cast<double>(audio::kDirectionParts);
                }
            }
        }
    }
    return pair;
}

/// Ears that receive an impulse from any direction, the right one half as strongly.
audio::HrirSet plain_ears(double sample_rate = 48000.0) {
    return {.sample_rate = sample_rate,
            .directions = {{.towards = {1.0, 0.0, 0.0}, .left = {1.0}, .right = {0.5}}}};
}

double energy_of(const std::vector<double>& samples) {
    return std::inner_product(samples.begin(), samples.end(), samples.begin(), 0.0);
}

TEST(Response, OfEarlyPathsIsTheSumOfTheirArrivals) {
    const PairResult pair = early_pair();
    const Response response = render_response(bands(), pair, {});
    const auto expected = audio::assemble(bands(), arrivals_of(pair));
    ASSERT_EQ(response.channels.size(), 1U);
    EXPECT_EQ(response.channels[0].samples, expected.samples);
    EXPECT_EQ(response.metrics.source, 1U);
    EXPECT_EQ(response.metrics.listener, 2U);
    EXPECT_EQ(response.metrics.time, 0.5);
    EXPECT_FALSE(response.metrics.lateral);
    EXPECT_FALSE(response.metrics.binaural);
    EXPECT_FALSE(response.metrics.schroeder_hz);  // of no room that is known
}

TEST(Response, OfSilenceIsSilence) {
    const Response response = render_response(bands(), {}, {}, {.length = 0.25});
    EXPECT_EQ(response.channels[0].samples, std::vector<double>(12000, 0.0));
}

TEST(Response, IsAsLongAsItsLateSoundUnlessALengthIsAskedFor) {
    const PairResult pair = whole_pair();
    EXPECT_EQ(render_response(bands(), pair, {}).channels[0].samples.size(), 24000U);
    EXPECT_EQ(render_response(bands(), pair, {}, {.length = 0.1}).channels[0].samples.size(),
              4800U);
}

TEST(Response, GivesLateSoundItsEnergyAndDecay) {
    PairResult pair = whole_pair();
    pair.paths.clear();
    const Response response = render_response(bands(), pair, {});
    double late = 0.0;
    for (const audio::Spectrum& energy : pair.late.energy) {
        late += energy[0];
    }
    // Noise that falls by 60 dB in 0.4 s has some 2800 samples until it is 4.3 dB down, so one
    // standard deviation of its energy is about 3 %.
    EXPECT_NEAR(energy_of(response.channels[0].samples) / late, 1.0, 0.12);
    const auto& expected = response.metrics.expected.bands[5].reverberation_time_t30;
    ASSERT_TRUE(expected);
    EXPECT_NEAR(*expected, 0.4, 0.004);
}

TEST(Response, HasNoiseOfItsOwnForEachPairAndTheSameAtAllTimes) {
    PairResult pair = whole_pair();
    const auto samples = [&] { return render_response(bands(), pair, {}).channels[0].samples; };
    const std::vector<double> first = samples();
    pair.time = 2.0;
    EXPECT_EQ(samples(), first);
    pair.listener = 3;  // its number is nobody's business
    EXPECT_EQ(samples(), first);
    pair.key = 3;
    EXPECT_NE(samples(), first);
}

TEST(Response, InAmbisonicsHasThePressureInItsFirstChannel) {
    const ResponseFormat format = {.channels = Channels::ambisonic, .ambisonic_order = 1};
    const Response response = render_response(bands(), early_pair(), {}, format);
    ASSERT_EQ(response.channels.size(), 4U);
    EXPECT_EQ(response.channels[0].samples,
              render_response(bands(), early_pair(), {}).channels[0].samples);
    EXPECT_TRUE(response.metrics.lateral);
    // ACN: Y, Z, X. Only the reflection comes from the side, and nothing from above.
    const auto reflection =
        audio::assemble(bands(), std::vector{arrivals_of(early_pair())[1]}, {.length = 0.0});
    EXPECT_NEAR(energy_of(response.channels[1].samples),
                energy_of(reflection.samples),
                1e-9 * energy_of(reflection.samples));
    EXPECT_EQ(energy_of(response.channels[2].samples), 0.0);
    const Response whole = render_response(bands(), whole_pair(), {}, format);
    EXPECT_GT(energy_of(whole.channels[2].samples), 0.0);
    EXPECT_EQ(whole.channels[0].samples.size(), whole.channels[3].samples.size());
}

TEST(Response, ForTwoEarsIsMeasuredWithoutTheHead) {
    const ResponseFormat format = {.channels = Channels::binaural, .hrir_set = plain_ears()};
    const Response response = render_response(bands(), whole_pair(), {}, format);
    const Response mono = render_response(bands(), whole_pair(), {});
    ASSERT_EQ(response.channels.size(), 2U);
    EXPECT_NEAR(energy_of(response.channels[1].samples) / energy_of(response.channels[0].samples),
                0.25,
                1e-9);
    EXPECT_TRUE(response.metrics.binaural);
    EXPECT_EQ(response.metrics.response.bands[5].clarity_c80_db,
              mono.metrics.response.bands[5].clarity_c80_db);
}

TEST(Response, TakesHeadResponsesOfAnySampleRate) {
    for (const double rate : {24000.0, 96000.0}) {
        const ResponseFormat format = {.channels = Channels::binaural,
                                       .hrir_set = plain_ears(rate)};
        const Response response = render_response(bands(), early_pair(), {}, format);
        EXPECT_EQ(response.channels[0].sample_rate, 48000.0);
        EXPECT_GT(energy_of(response.channels[0].samples), 0.0);
    }
}

TEST(Response, OfOneRendererIsThatOfTheFunction) {
    const ResponseFormat format = {.sample_rate = 16000.0, .seed = 7};
    const ResponseRenderer renderer(bands(), format);
    for (const PairResult& pair : {early_pair(), whole_pair()}) {
        Executor two(2);
        EXPECT_EQ(renderer.render(pair, {}, two).channels[0].samples,
                  render_response(bands(), pair, {}, format).channels[0].samples);
    }
}

TEST(Response, RefusesFormatsThatCannotBeRendered) {
    const auto render = [](const ResponseFormat& format) {
        return render_response(bands(), early_pair(), {}, format);
    };
    EXPECT_THROW(render({.channels = Channels::ambisonic, .ambisonic_order = -1}), Error);
    EXPECT_THROW(render({.channels = Channels::ambisonic, .ambisonic_order = 6}), Error);
    EXPECT_THROW(render({.channels = Channels::binaural}), Error);
    EXPECT_THROW(render({.sample_rate = 10.0}), Error);
    EXPECT_THROW(render({.length = -1.0}), Error);
}

}  // namespace
}  // namespace earshot::propagation
