// SPDX-License-Identifier: MIT
#include "earshot/audio/auralization.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace earshot::audio {
namespace {

using Samples = std::vector<double>;

/// The convolution as its definition has it.
Samples plain_convolution(const Samples& a, const Samples& b) {
    Samples sum(a.size() + b.size() - 1, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t k = 0; k < b.size(); ++k) {
            sum[i + k] += a[i] * b[k];
        }
    }
    return sum;
}

void expect_near(const Samples& found, const Samples& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t n = 0; n < found.size(); ++n) {
        EXPECT_NEAR(found[n], expected[n], 1e-12) << n;
    }
}

const Samples kDry = {1.0, -0.5, 0.25, 2.0};
const Samples kOther = {0.5, 0.0, -1.0, 0.125};
const Samples kLeft = {0.5, 0.25, -0.125}, kRight = {-1.0, 0.0, 0.75};

TEST(Auralization, OneRecordingIsHeardInEveryChannelOfTheReceiver) {
    const std::vector<Signal> responses = {{48000, {kLeft, kRight}}};
    const Signal wet = auralize({48000, {kDry}}, responses);
    EXPECT_EQ(wet.sample_rate, 48000);
    ASSERT_EQ(wet.channels.size(), 2U);
    expect_near(wet.channels[0], plain_convolution(kDry, kLeft));
    expect_near(wet.channels[1], plain_convolution(kDry, kRight));
}

TEST(Auralization, AReceiverOfOneChannelServesEveryChannelOfTheRecording) {
    const std::vector<Signal> responses = {{48000, {kLeft}}};
    const Signal wet = auralize({48000, {kDry, kOther}}, responses);
    ASSERT_EQ(wet.channels.size(), 2U);
    expect_near(wet.channels[0], plain_convolution(kDry, kLeft));
    expect_near(wet.channels[1], plain_convolution(kOther, kLeft));
}

TEST(Auralization, EqualNumbersOfChannelsGoOneToOne) {
    const std::vector<Signal> responses = {{48000, {kLeft, kRight}}};
    const Signal wet = auralize({48000, {kDry, kOther}}, responses);
    ASSERT_EQ(wet.channels.size(), 2U);
    expect_near(wet.channels[0], plain_convolution(kDry, kLeft));
    expect_near(wet.channels[1], plain_convolution(kOther, kRight));
}

TEST(Auralization, TheRecordingGetsTheRateOfTheResponses) {
    const std::vector<Signal> responses = {{24000, {{1.0}}}};
    const Signal wet = auralize({48000, {Samples(480, 0.0)}}, responses);
    EXPECT_EQ(wet.sample_rate, 24000);
    EXPECT_EQ(wet.channels[0].size(), 240U);
}

TEST(Auralization, TellsWhichChannelsFit) {
    const auto of = [](std::size_t channels) {
        return Signal{48000, std::vector<Samples>(channels)};
    };
    EXPECT_TRUE(channels_fit(of(1), of(4)));
    EXPECT_TRUE(channels_fit(of(4), of(1)));
    EXPECT_TRUE(channels_fit(of(2), of(2)));
    EXPECT_FALSE(channels_fit(of(2), of(4)));
    EXPECT_FALSE(channels_fit(of(4), of(2)));
}

TEST(Auralization, SumsGrowToTheLongestPart) {
    Signal sum{48000, std::vector<Samples>(1)};
    add_scaled({48000, {{1.0, 2.0}}}, 0.5, sum);
    add_scaled({48000, {{1.0, 1.0, 4.0}}}, 2.0, sum);
    add_scaled({48000, {{1.0}}}, -1.0, sum);
    EXPECT_EQ(sum.channels[0], (Samples{1.5, 3.0, 8.0}));
}

}  // namespace
}  // namespace earshot::audio
