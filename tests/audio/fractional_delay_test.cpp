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
    for (double fraction = 1.0 / 64; fraction < 1.0; fraction += 1.0 / 64) {
        const auto taps = fractional_impulse(fraction);
        const double delay = static_cast<double>(kDelayHalfLength) - 1.0 + fraction;
        for (double part = 0.0; part <= 0.95; part += 0.005) {
            const double omega = part * std::numbers::pi;
            worst =
                std::max(worst, std::abs(gain_at(taps, omega) - std::polar(1.0, -omega * delay)));
        }
    }
    // Twice the ripple of the window: the taps are scaled by up to one ripple to sum to 1.
    EXPECT_LT(worst, 2e-5);
}

TEST(FractionalImpulse, HasUnitGainAtZeroFrequency) {
    for (double fraction = 0.0; fraction < 1.0; fraction += 0.013) {
        EXPECT_NEAR(gain_at(fractional_impulse(fraction), 0.0).real(), 1.0, 1e-13);
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
