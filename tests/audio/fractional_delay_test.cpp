// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fractional_delay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace earshot::audio {
namespace {

std::complex<double> gain_at(const std::array<double, kDelayTaps>& taps, double omega) {
    std::complex<double> sum = 0.0;
    for (std::size_t n = 0; n < taps.size(); ++n) {
        sum += std::polar(taps[n], -omega * static_cast<double>(n));
    }
    return sum;
}

TEST(FractionalImpulse, OfAWholeSampleIsOneTap) {
    const auto taps = fractional_impulse(0.0);
    for (std::size_t n = 0; n < taps.size(); ++n) {
        EXPECT_EQ(taps[n], n + 1 == kDelayHalfLength ? 1.0 : 0.0);
    }
}

TEST(FractionalImpulse, IsAPureDelayUpToTheStatedFrequency) {
    double worst = 0.0;
    for (int step = 1; step < 64; ++step) {
        const double fraction = step / 64.0;
        const auto taps = fractional_impulse(fraction);
        const double delay = static_cast<double>(kDelayHalfLength) - 1.0 + fraction;
        for (int part = 0; part <= 190; ++part) {
            const double omega = part / 200.0 * std::numbers::pi;
            worst =
                std::max(worst, std::abs(gain_at(taps, omega) - std::polar(1.0, -omega * delay)));
        }
    }
    // The ripple of the window, once more because the taps are scaled to sum to 1, and the slope
    // of the transition, which begins here.
    EXPECT_LT(worst, 2.5e-5);
}

TEST(FractionalImpulse, HasUnitGainAtZeroFrequency) {
    for (int step = 0; step < 77; ++step) {
        EXPECT_NEAR(gain_at(fractional_impulse(step / 77.0), 0.0).real(), 1.0, 1e-13);
    }
}

TEST(FractionalImpulse, IsContinuousWhereTheSampleChanges) {
    const auto before = fractional_impulse(1.0 - 1e-12);
    const auto after = fractional_impulse(0.0);
    for (std::size_t n = 1; n < kDelayTaps; ++n) {
        EXPECT_NEAR(before[n], after[n - 1], 1e-11);
    }
}

}  // namespace
}  // namespace earshot::audio
