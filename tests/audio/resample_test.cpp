// SPDX-License-Identifier: MIT
#include "earshot/audio/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace earshot::audio {
namespace {

// A tone is known between its samples.
std::vector<double> tone(double frequency_hz, std::int64_t rate, std::size_t size) {
    std::vector<double> samples(size);
    for (std::size_t n = 0; n < size; ++n) {
        samples[n] =
            std::sin(2.0 * std::numbers::pi * frequency_hz * double(n) / double(rate) + 0.3);
    }
    return samples;
}

TEST(Resample, ATonesSamplesAreThoseOfTheToneAtTheNewRate) {
    const std::pair<std::int64_t, std::int64_t> rates[] = {{44100, 48000},
                                                           {48000, 44100},
                                                           {48000, 16000},
                                                           {96000, 44100},
                                                           {8000, 192000},
                                                           {48000, 48001}};
    for (const auto& [from, to] : rates) {
        const auto lower = double(std::min(from, to));
        for (const double share : {0.01, 0.2, 0.45}) {
            const std::size_t size = std::size_t(from / 10);
            const auto got = resample(tone(share * lower, from, size), from, to);
            const auto expected = tone(share * lower, to, got.size());
            ASSERT_EQ(got.size(), std::size_t(std::ceil(double(size) * double(to) / double(from))));
            // The ends lack the samples beyond them: 64 of the lower rate.
            const auto margin = std::size_t(65.0 * double(to) / lower);
            for (std::size_t n = margin; n + margin < got.size(); ++n) {
                ASSERT_NEAR(got[n], expected[n], 1e-4) << from << " to " << to << ", " << n;
            }
        }
    }
}

TEST(Resample, RemovesWhatTheLowerRateCannotHold) {
    for (const double frequency_hz : {8500.0, 12000.0, 20000.0}) {
        const auto got = resample(tone(frequency_hz, 48000, 9600), 48000, 16000);
        for (std::size_t n = 80; n + 80 < got.size(); ++n) {
            ASSERT_NEAR(got[n], 0.0, 1e-4) << frequency_hz;
        }
    }
}

TEST(Resample, KeepsSamplesOfOneRateAndTheEmptySignal) {
    const std::vector<double> samples = {1.0, -0.25, 3.0};
    EXPECT_EQ(resample(samples, 44100, 44100), samples);
    EXPECT_TRUE(resample({}, 44100, 48000).empty());
}

}  // namespace
}  // namespace earshot::audio
