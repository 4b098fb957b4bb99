// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fractional_delay.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

// Kaiser and Schafer 1980: beta = 0.1102 (A - 8.7) gives ripples A = 100 dB down (1e-5), and a
// transition of (A - 8) / (2.285 (taps - 1)) radians, centred on half the sample rate: 0.1 of it
// with 128 taps, one half of which lies below.
constexpr double kBeta = 0.1102 * (100.0 - 8.7);
constexpr double kHalf = static_cast<double>(kDelayHalfLength);

// Modified Bessel function of order 0: sum of ((x/2)^k / k!)^2. For x <= kBeta the terms past 40
// are below the last bit of the sum.
constexpr int kBesselTerms = 40;

double bessel_i0(double x) noexcept {
    const double quarter = 0.25 * x * x;
    double term = 1.0;
    double sum = 1.0;
    for (int k = 1; k <= kBesselTerms; ++k) {
        term *= quarter / (static_cast<double>(k) * static_cast<double>(k));
        sum += term;
    }
    return sum;
}

}  // namespace

std::array<double, kDelayTaps> fractional_impulse(double fraction) {
    EARSHOT_ASSERT(fraction >= 0.0 && fraction < 1.0);
    std::array<double, kDelayTaps> taps{};
    if (fraction == 0.0) {
        taps[kDelayHalfLength - 1] = 1.0;
        return taps;
    }
    // sin(pi t) of every tap is that of the fraction with alternating sign.
    const double sine = math::sin(math::kPi * fraction) / math::kPi;
    double sum = 0.0;
    for (std::size_t tap = 0; tap < kDelayTaps; ++tap) {
        const double t = static_cast<double>(tap) - (kHalf - 1.0) - fraction;
        const double sign = (tap + kDelayHalfLength) % 2 == 1 ? -1.0 : 1.0;
        const double window = bessel_i0(kBeta * std::sqrt(1.0 - (t / kHalf) * (t / kHalf)));
        taps[tap] = sign * sine / t * window;
        sum += taps[tap];
    }
    for (double& tap : taps) {
        tap /= sum;
    }
    return taps;
}

std::array<double, kAllpassTaps> allpass_impulse(double delay) {
    EARSHOT_ASSERT(delay >= 0.0 && delay < kHalf);
    // The filter is stable for delays above order - 1; its delay stays flat to the highest
    // frequencies if the delay is a little below the order.
    const auto order = static_cast<std::size_t>(std::max(1.0, std::floor(delay + 0.7)));
    std::array<double, kDelayHalfLength + 1> a{};
    a[0] = 1.0;
    for (std::size_t k = 0; k < order; ++k) {
        const double below = static_cast<double>(order - k);
        const double next = static_cast<double>(k) + 1.0;
        a[k + 1] = -a[k] * below / next * (delay - below) / (delay + next);
    }
    // The numerator has the coefficients of the denominator in reverse.
    std::array<double, kAllpassTaps> taps{};
    for (std::size_t n = 0; n < kAllpassTaps; ++n) {
        double value = n <= order ? a[order - n] : 0.0;
        for (std::size_t k = 1; k <= std::min(order, n); ++k) {
            value -= a[k] * taps[n - k];
        }
        taps[n] = value;
    }
    return taps;
}

}  // namespace earshot::audio
