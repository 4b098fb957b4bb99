// SPDX-License-Identifier: MIT
#include "earshot/audio/tail_convolver.h"

#include "earshot/audio/convolve.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace earshot::audio {
namespace {

constexpr std::size_t kBlock = 32;
constexpr std::size_t kPeriod = kBlock * TailConvolver::kPeriod;
constexpr std::size_t kSamples = 40 * kPeriod;

std::vector<double> noise(std::uint64_t stream, std::size_t length) {
    std::vector<double> samples(length);
    for (std::size_t n = 0; n < length; ++n) {
        samples[n] = random(1, stream, n) - 0.5;
    }
    return samples;
}

std::vector<std::vector<double>> response(std::uint64_t stream) {
    return {noise(stream, 5000), noise(stream + 1, 3000)};
}

// Two sources and two channels; the tails of one are replaced while it plays. Before, it is the
// convolution with the old ones, two periods and a response later with the new ones: what both were
// at once lies between.
TEST(TailConvolver, ConvolvesAndFades) {
    const std::vector<std::vector<double>> first = response(10), other = response(20),
                                           later = response(30);
    const Tail a(first, kBlock), b(other, kBlock), c(later, kBlock);
    TailConvolver convolver({.sources = 2, .channels = 2, .block = kBlock, .max_length = 5000});
    const std::vector<std::vector<double>> dry = {noise(1, kSamples), noise(2, kSamples)};
    std::vector<std::vector<double>> heard(2);
    for (std::size_t begin = 0; begin < kSamples; begin += kBlock) {
        if (begin == 0) {
            ASSERT_TRUE(convolver.begins_period());
            convolver.set_tails(std::vector<const Tail*>{&a, &b});
        } else if (begin == 20 * kPeriod) {
            ASSERT_TRUE(convolver.begins_period());
            convolver.set_tails(std::vector<const Tail*>{&c, &b});
        }
        std::vector<float> in(2 * kBlock), out(2 * kBlock, 1.0F);
        for (std::size_t n = 0; n < kBlock; ++n) {
            in[n] = static_cast<float>(dry[0][begin + n]);
            in[kBlock + n] = static_cast<float>(dry[1][begin + n]);
        }
        convolver.process(in.data(), out.data());
        for (std::size_t channel = 0; channel < 2; ++channel) {
            for (std::size_t n = 0; n < kBlock; ++n) {
                heard[channel].push_back(out[channel * kBlock + n] - 1.0);
            }
        }
    }
    for (std::size_t channel = 0; channel < 2; ++channel) {
        const std::vector<double> of_first = convolve(dry[0], first[channel]);
        const std::vector<double> of_later = convolve(dry[0], later[channel]);
        const std::vector<double> of_other = convolve(dry[1], other[channel]);
        for (std::size_t n = 2 * kPeriod; n < kSamples; ++n) {
            const double before = of_first[n] + of_other[n];
            const double after = of_later[n] + of_other[n];
            if (n < 20 * kPeriod) {
                ASSERT_NEAR(heard[channel][n], before, 2e-4) << n;
            } else if (n >= 22 * kPeriod) {
                ASSERT_NEAR(heard[channel][n], after, 2e-4) << n;
            } else if (n == 20 * kPeriod) {
                ASSERT_NEAR(heard[channel][n], before, 2e-4);
            }
        }
    }
}

TEST(TailConvolver, IsSilentWithoutTails) {
    TailConvolver convolver({.sources = 1, .channels = 1, .block = kBlock, .max_length = 1000});
    const std::vector<float> in(kBlock, 1.0F);
    std::vector<float> out(kBlock, 0.0F);
    for (int block = 0; block < 50; ++block) {
        convolver.process(in.data(), out.data());
        EXPECT_EQ(out, std::vector<float>(kBlock, 0.0F));
    }
}

}  // namespace
}  // namespace earshot::audio
