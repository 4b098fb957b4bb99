// SPDX-License-Identifier: MIT
#include "earshot/audio/measured_response.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace earshot::audio {
namespace {

constexpr double kRate = 48000.0;

// A decay of noise that begins at a sample with its largest value, 1.
ImpulseResponse decay(std::size_t onset, std::size_t size, double time = 0.5) {
    ImpulseResponse response{kRate, std::vector<double>(size)};
    response.samples[onset] = 1.0;
    for (std::size_t n = onset + 1; n < size; ++n) {
        response.samples[n] = random_between(4, 2, n, -0.9, 0.9) *
                              std::exp(-6.907755 * double(n - onset) / kRate / time);
    }
    return response;
}

bool tells(const MeasuredResponse& measured, const std::string& text) {
    return std::any_of(measured.notes.begin(), measured.notes.end(), [&](const MetricNote& note) {
        return note.metric == "all" && note.text.find(text) != std::string::npos;
    });
}

TEST(MeasuredResponse, LeavesOutPaddingAndWhatPrecedesTheSound) {
    ImpulseResponse recording = decay(0, 20000);
    recording.samples.insert(recording.samples.begin(), 30000, 0.0);
    recording.samples.resize(recording.samples.size() + 24000, 0.0);
    const auto measured = measured_response(recording);
    ASSERT_TRUE(measured);
    EXPECT_EQ(measured->onset, 30000U);
    // One constant sample at either end belongs to the response.
    EXPECT_EQ(measured->begin, 29999U);
    EXPECT_EQ(measured->response.samples.size(), 20002U);
    EXPECT_TRUE(tells(*measured, "0.625 s of constant samples at the beginning"));
    EXPECT_TRUE(tells(*measured, "0.500 s of constant samples at the end"));
    const ImpulseResponse same = same_part(*measured, recording);
    EXPECT_EQ(same.samples, measured->response.samples);
}

TEST(MeasuredResponse, TakesAnOffsetOut) {
    ImpulseResponse recording = decay(600, 48000);
    for (double& sample : recording.samples) {
        sample += 0.25;
    }
    const auto measured = measured_response(recording);
    ASSERT_TRUE(measured);
    EXPECT_NEAR(measured->offset, 0.25, 1e-3);
    EXPECT_EQ(measured->onset, 600U);
    EXPECT_TRUE(tells(*measured, "an offset of 0.25 is taken out"));
    EXPECT_NEAR(measured->response.samples.back(), 0.0, 1e-3);
}

TEST(MeasuredResponse, OfConstantSamplesIsNothing) {
    EXPECT_FALSE(measured_response({kRate, {}}));
    EXPECT_FALSE(measured_response({kRate, {0.5}}));
    EXPECT_FALSE(measured_response({kRate, std::vector<double>(1000, 0.5)}));
    EXPECT_FALSE(measured_response(decay(0, 1000), 1000));
}

TEST(MeasuredOnset, PassesOverHarmonicsOfASweep) {
    const ImpulseResponse response = decay(0, 48000);
    for (const double level_db : {-12.0, -19.0, -30.0}) {
        std::vector<double> samples(response.samples.size() + 24000, 0.0);
        for (std::size_t n = 0; n < response.samples.size(); ++n) {
            samples[n + 24000] += response.samples[n];
            samples[n + 4800] += std::pow(10.0, level_db / 20.0) * response.samples[n];
        }
        const auto onset = find_measured_onset(samples, kRate);
        ASSERT_TRUE(onset);
        EXPECT_EQ(onset->onset, 24000U) << level_db;
        EXPECT_EQ(onset->pre_arrival.has_value(), level_db > -20.0) << level_db;
        if (onset->pre_arrival) {
            EXPECT_EQ(onset->pre_arrival->onset, 4800U);
            EXPECT_NEAR(onset->pre_arrival->level_db, level_db, 0.2);
        }
    }
}

TEST(MeasuredOnset, KeepsTheDirectSoundBeforeALouderReflection) {
    // 40 ms later and 6 dB louder, as behind an obstacle; and an echo 0.3 s later of 3 dB less.
    std::vector<double> samples(48000, 0.0);
    samples[1000] = 0.5;
    samples[1000 + 1920] = 1.0;
    samples[1000 + 14400] = 0.7;
    const auto onset = find_measured_onset(samples, kRate);
    ASSERT_TRUE(onset);
    EXPECT_EQ(onset->onset, 1000U);
    EXPECT_FALSE(onset->pre_arrival);
    EXPECT_FALSE(find_measured_onset(std::vector<double>(100, 0.0), kRate));
}

TEST(Clipping, IsSeveralEqualExtremesWithAKink) {
    ImpulseResponse recording = decay(100, 48000);
    EXPECT_EQ(find_clipping(recording.samples).samples, 0U);
    EXPECT_TRUE(find_clipping(recording.samples).one_at_full_scale);
    std::size_t expected = 0;
    double energy = 0.0;
    double clipped = 0.0;
    for (std::size_t n = 0; n < recording.samples.size(); ++n) {
        double& sample = recording.samples[n];
        sample = std::clamp(sample, -0.5, 0.5);
        energy += sample * sample;
        if (std::abs(sample) == 0.5) {
            ++expected;
            clipped += 0.25;
        }
    }
    const Clipping found = find_clipping(recording.samples);
    ASSERT_GT(expected, 10U);
    EXPECT_EQ(found.samples, expected);
    EXPECT_NEAR(found.level_db, -6.02, 0.01);
    EXPECT_NEAR(found.energy_share, clipped / energy, 1e-12);
    EXPECT_LT(found.energy_after_db, 0.0);
    EXPECT_FALSE(found.one_at_full_scale);
}

TEST(Clipping, IsNotACrestThatQuantisationMakesFlat) {
    std::vector<double> samples;
    for (int n = 0; n < 4800; ++n) {
        samples.push_back(std::round(20000.0 * std::sin(0.004 * n)) / 32768.0);
    }
    EXPECT_EQ(find_clipping(samples).samples, 0U);
    for (double& sample : samples) {
        sample = std::clamp(sample, -0.4, 0.4);
    }
    EXPECT_GT(find_clipping(samples).samples, 1000U);
}

TEST(Clipping, IsSeveralSamplesAtFullScale) {
    std::vector<double> samples = {0.0, 0.3, 32767.0 / 32768.0, -0.2, -1.0, 0.1, 0.0};
    EXPECT_EQ(find_clipping(samples).samples, 2U);
    samples[4] = -0.9;
    EXPECT_EQ(find_clipping(samples).samples, 0U);
    EXPECT_TRUE(find_clipping(samples).one_at_full_scale);
    samples[2] = 0.9;
    EXPECT_FALSE(find_clipping(samples).one_at_full_scale);
    samples[2] = 1.5;  // a file of floating-point samples
    samples[4] = -1.5;
    EXPECT_FALSE(find_clipping(samples).one_at_full_scale);
    EXPECT_EQ(find_clipping(samples).samples, 0U);
    EXPECT_EQ(find_clipping({}).samples, 0U);
}

}  // namespace
}  // namespace earshot::audio
