// SPDX-License-Identifier: MIT
#include "earshot/audio/source_lines.h"

#include "earshot/audio/filter_basis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace earshot::audio {
namespace {

constexpr double kRate = 48000.0;
constexpr double kMetresPerSample = 343.2 / kRate;
constexpr std::size_t kBlock = 256;

/// Plays a tone whose delay is a line, and tells the largest error re the tone's amplitude.
double largest_error(double frequency, double rate) {
    const Assembler assembler(Bands::octaves(), kRate);
    const FilterBasis basis(assembler, {}, {});
    SourceLines lines(basis, {.block = kBlock, .max_delay = 9600});
    ArrivalMixer mixer(kBlock, kMetresPerSample);
    const auto tone = [&](double sample) {
        return std::sin(2.0 * std::numbers::pi * frequency * sample / kRate);
    };
    double error = 0.0;
    for (std::size_t begin = 0; begin < 60 * kBlock; begin += kBlock) {
        std::vector<float> in(kBlock), out(kBlock, 0.0F);
        for (std::size_t n = 0; n < kBlock; ++n) {
            in[n] = static_cast<float>(tone(static_cast<double>(begin + n)));
        }
        lines.push(in.data());
        const double delay = 5000.3 + rate * static_cast<double>(begin);
        const float one = 1.0F, none = 0.0F;
        EXPECT_TRUE(mixer.add(lines,
                              {.delay = {delay, rate, 0.0, 0.0},
                               .weights = {&one, 1},
                               .weight_steps = {&none, 1},
                               .gains = {&one, 1},
                               .gain_steps = {&none, 1}},
                              out.data()));
        for (std::size_t n = 0; begin > 24 * kBlock && n < kBlock; ++n) {
            const double late = delay + rate * static_cast<double>(n);
            const double heard = tone(static_cast<double>(begin + n) - kArrivalLatency - late);
            error = std::max(error, std::abs(out[n] * late * kMetresPerSample - heard));
        }
    }
    return error;
}

// Whatever differs from the tone that should be heard, a line of its own or an error of level.
TEST(SourceLines, KeepTonesWithin85Decibels) {
    for (const double frequency : {100.0, 1000.0, 9000.0, 16000.0, 18000.0}) {
        for (const double rate : {0.0, 0.001, 0.03, -0.2}) {
            EXPECT_LT(20.0 * std::log10(largest_error(frequency, rate)), -85.0)
                << frequency << " Hz, " << rate;
        }
    }
}

// Two channels, a weight of a filter and gains that change: against the sum by its definition.
TEST(SourceLines, AddWeightedFiltersToChannels) {
    const Assembler assembler(Bands::octaves(), kRate);
    Spectrum muffled{};
    for (std::size_t band = 0; band < 10; ++band) {
        muffled[band] = 1.0 / static_cast<double>(1 + band);
    }
    const FilterBasis basis(assembler, {&muffled, 1}, {});
    ASSERT_EQ(basis.filters(), 2U);
    std::vector<double> exact(2, 0.0);
    EXPECT_LT(basis.add_weights(muffled, exact), 1e-9);
    EXPECT_NEAR(exact[0], 0.0, 1e-9);
    EXPECT_NEAR(exact[1], 1.0, 1e-9);

    SourceLines lines(basis, {.block = kBlock, .max_delay = 4800});
    ArrivalMixer mixer(kBlock, kMetresPerSample);
    const std::vector<float> weights = {0.5F, 2.0F}, weight_steps = {0.0F, 0.0F};
    const std::vector<float> gains = {1.0F, -2.0F}, gain_steps = {0.001F, 0.0F};
    std::vector<float> heard;
    const std::span<const double> taps = basis.taps(1);
    constexpr std::size_t kDelay = 301;
    for (std::size_t begin = 0; begin < 8192; begin += kBlock) {
        std::vector<float> in(kBlock, 0.0F), out(2 * kBlock, 0.0F);
        in[0] = begin == 0 ? 1.0F : 0.0F;
        lines.push(in.data());
        ASSERT_TRUE(mixer.add(lines,
                              {.delay = {kDelay, 0.0, 0.0, 0.0},
                               .weights = weights,
                               .weight_steps = weight_steps,
                               .gains = gains,
                               .gain_steps = gain_steps},
                              out.data()));
        for (std::size_t n = 0; n < kBlock; ++n) {
            const auto k = static_cast<std::ptrdiff_t>(begin + n) -
                           static_cast<std::ptrdiff_t>(kDelay + kArrivalLatency);
            double expected = k == 0 ? 0.5 : 0.0;
            if (k >= 0 && k < static_cast<std::ptrdiff_t>(taps.size())) {
                expected += 2.0 * taps[static_cast<std::size_t>(k)];
            }
            expected /= kDelay * kMetresPerSample;
            const double gain = 1.0 + 0.001 * static_cast<double>(n);
            ASSERT_NEAR(out[n], gain * expected, 1e-6) << begin + n;
            ASSERT_NEAR(out[kBlock + n], -2.0 * expected, 1e-6) << begin + n;
        }
    }
}

TEST(SourceLines, AreSilentWhereNothingIsKept) {
    const Assembler assembler(Bands::octaves(), kRate);
    const FilterBasis basis(assembler, {}, {});
    SourceLines lines(basis, {.block = kBlock, .max_delay = 1000});
    ArrivalMixer mixer(kBlock, kMetresPerSample);
    const std::vector<float> in(kBlock, 1.0F);
    std::vector<float> out(kBlock, 0.0F);
    lines.push(in.data());
    const float one = 1.0F, none = 0.0F;
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    for (const double delay : {-300.0, 1e5, 1e300, kNaN}) {
        EXPECT_FALSE(mixer.add(lines,
                               {.delay = {delay, 0.0, 0.0, 0.0},
                                .weights = {&one, 1},
                                .weight_steps = {&none, 1},
                                .gains = {&one, 1},
                                .gain_steps = {&none, 1}},
                               out.data()))
            << delay;
    }
    EXPECT_EQ(out, std::vector<float>(kBlock, 0.0F));
}

}  // namespace
}  // namespace earshot::audio
