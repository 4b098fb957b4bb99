// SPDX-License-Identifier: MIT
#include "earshot/audio/delay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace earshot::audio {
namespace {

using Samples = std::vector<double>;

std::complex<double> spectrum(const Samples& samples, double omega) {
    std::complex<double> sum = 0.0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        sum += std::polar(samples[n], -omega * static_cast<double>(n));
    }
    return sum;
}

TEST(Delayed, ByWholeSamplesKeepsThem) {
    EXPECT_EQ(delayed(Samples{1.0, -2.0}, 0.0), (Samples{1.0, -2.0}));
    EXPECT_EQ(delayed(Samples{1.0, -2.0}, 3.0), (Samples{0.0, 0.0, 0.0, 1.0, -2.0}));
    EXPECT_EQ(delayed(Samples{}, 2.0), (Samples{0.0, 0.0}));
}

TEST(Delayed, BetweenSamplesTurnsThePhase) {
    const Samples samples = {1.0, -0.5, 0.25};
    for (const double delay : {80.5, 100.125, 150.9}) {
        const Samples result = delayed(samples, delay);
        EXPECT_EQ(result.size(), static_cast<std::size_t>(delay) + samples.size() + 64);
        for (double omega = 0.0; omega < 2.98; omega += 0.1) {
            const auto expected = spectrum(samples, omega) * std::polar(1.0, -omega * delay);
            EXPECT_LT(std::abs(spectrum(result, omega) - expected), 5e-5) << delay << " " << omega;
        }
    }
}

}  // namespace
}  // namespace earshot::audio
