// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fractional_delay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <vector>

namespace earshot::audio {
namespace {

std::complex<double> gain_at(std::span<const double> taps, double omega) {
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

TEST(DelayTable, HoldsTheImpulsesOfAllFractions) {
    const DelayTable table;
    std::array<double, kDelayTaps> found{};
    for (int step = 0; step < 7777; ++step) {
        const double fraction = step / 7777.0;
        table.impulse(fraction, found);
        const auto expected = fractional_impulse(fraction);
        double worst = 0.0;
        for (std::size_t n = 0; n < kDelayTaps; ++n) {
            worst = std::max(worst, std::abs(found[n] - expected[n]));
        }
        EXPECT_LT(worst, step == 0 ? 1e-300 : 1e-6) << fraction;
    }
}

TEST(DelaySpectrum, IsThatOfTheImpulses) {
    const RealFft fft(640);
    const DelaySpectrum delays(fft);
    for (const double fraction : {0.0, 0.125, 0.5, 0.77, 0.999}) {
        std::vector<std::complex<double>> spectrum((fft.bins() + 7) / 8 * 8, {0.0, 2.0});
        delays.apply(fraction, spectrum);
        const auto taps = fractional_impulse(fraction);
        for (std::size_t k = 0; k + 1 < fft.bins(); ++k) {
            const double omega = 2.0 * std::numbers::pi * static_cast<double>(k) / 640.0;
            const auto expected = std::complex<double>(0.0, 2.0) * gain_at(taps, omega);
            EXPECT_LT(std::abs(spectrum[k] - expected), 2.0 * 2e-6) << fraction << " " << k;
        }
    }
}

TEST(AllpassImpulse, HasUnitMagnitudeAtAllFrequencies) {
    for (int step = 3; step < 6400; step += 7) {
        const auto taps = allpass_impulse(step / 100.0);
        for (int part = 0; part <= 20; ++part) {
            const double gain = std::abs(gain_at(taps, part / 20.0 * std::numbers::pi));
            EXPECT_NEAR(20.0 * std::log10(gain), 0.0, 0.002) << step << " " << part;
        }
    }
}

TEST(AllpassImpulse, HasItsDelayAtLowFrequencies) {
    for (int step = 3; step < 6400; step += 7) {
        const double delay = step / 100.0;
        const auto taps = allpass_impulse(delay);
        for (const double omega : {0.01, 0.1, 0.25 * std::numbers::pi}) {
            const double phase = std::arg(gain_at(taps, omega) * std::polar(1.0, omega * delay));
            EXPECT_NEAR(phase / omega, 0.0, omega < 0.5 ? 0.01 : 0.1) << delay;
        }
    }
}

TEST(AllpassImpulse, OfAWholeSampleIsOneTap) {
    for (const std::size_t delay : {0U, 1U, 2U, 40U}) {
        const auto taps = allpass_impulse(static_cast<double>(delay));
        for (std::size_t n = 0; n < taps.size(); ++n) {
            EXPECT_NEAR(taps[n], n == delay ? 1.0 : 0.0, 1e-12) << delay << " " << n;
        }
    }
}

}  // namespace
}  // namespace earshot::audio
