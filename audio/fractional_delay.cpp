// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fractional_delay.h"

#include "earshot/audio/internal/arrival_filter_kernel.h"
#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

// Kaiser and Schafer 1980: beta = 0.1102 (A - 8.7) gives ripples A = 100 dB down (1e-5), and a
// transition of (A - 8) / (2.285 (taps - 1)) radians, centred on half the sample rate: 0.1 of it
// with 128 taps, one half of which lies below.
constexpr double kBeta = 0.1102 * (100.0 - 8.7);
constexpr double kHalf = static_cast<double>(kDelayHalfLength);

}  // namespace

namespace {

// For x <= kMaxBesselArgument the terms past 40 are below the last bit of the sum.
constexpr int kBesselTerms = 40;

}  // namespace

// The sum of ((x/2)^k / k!)^2.
double bessel_i0(double x) noexcept {
    EARSHOT_ASSERT(std::abs(x) <= kMaxBesselArgument);
    const double quarter = 0.25 * x * x;
    double term = 1.0;
    double sum = 1.0;
    for (int k = 1; k <= kBesselTerms; ++k) {
        const double ratio = quarter / (static_cast<double>(k) * static_cast<double>(k));
        term *= ratio;
        sum += term;
        if (ratio < 1.0 && term < 0x1p-54 * sum) {
            break;  // neither this term nor any later one changes the sum
        }
    }
    return sum;
}

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

DelayTable::DelayTable() : rows_((kDelayFractions + 1) * kDelayTaps, 0.0) {
    const auto row = [&](std::size_t k) { return &rows_[k * kDelayTaps]; };
    for (std::size_t k = 0; k <= kDelayFractions / 2; ++k) {
        const double fraction = static_cast<double>(k) / static_cast<double>(kDelayFractions);
        const std::array<double, kDelayTaps> taps = fractional_impulse(fraction);
        std::copy(taps.begin(), taps.end(), row(k));
        // An impulse that lies as far before the next sample is the mirror image.
        std::reverse_copy(taps.begin(), taps.end(), row(kDelayFractions - k));
    }
}

const DelayTable& DelayTable::shared() {
    static const DelayTable table;
    return table;
}

void DelayTable::impulse(double fraction, std::span<double, kDelayTaps> taps) const {
    EARSHOT_ASSERT(fraction >= 0.0 && fraction < 1.0);
    const double place = fraction * static_cast<double>(kDelayFractions);
    const auto below = static_cast<std::size_t>(place);
    const double* row = &rows_[below * kDelayTaps];
    interpolate(row, row + kDelayTaps, place - std::floor(place), kDelayTaps, taps.data());
}

DelaySpectrum::DelaySpectrum(const RealFft& fft)
    : angle_(padded(fft.bins()), 0.0), kernel_difference_(padded(fft.bins()), 0.0) {
    std::vector<double> signal(fft.size(), 0.0);
    const std::array<double, kDelayTaps> taps = fractional_impulse(0.5);
    std::copy(taps.begin(), taps.end(), signal.begin());
    std::vector<Complex> spectrum(fft.bins());
    fft.forward(signal, spectrum);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        angle_[k] = 2.0 * math::kPi * static_cast<double>(k) / static_cast<double>(fft.size());
        // Real but for rounding once the delay of 63.5 samples is taken out.
        const double turn = (kHalf - 0.5) * angle_[k];
        kernel_difference_[k] =
            spectrum[k].real() * math::cos(turn) - spectrum[k].imag() * math::sin(turn);
    }
}

void DelaySpectrum::apply(double fraction, std::span<Complex> spectrum) const {
    EARSHOT_ASSERT(spectrum.size() == angle_.size());
    const double turn = 2.0 * math::kPi * fraction;
    const Complex turned(math::cos(turn), math::sin(turn));
    // K0 + K1 turned, by the sum and the difference of K0 and K1.
    const SpectralDelay delay = {.delay = kHalf - 1.0 + fraction,
                                 .sum = 0.5 * (1.0 + turned),
                                 .difference = 0.5 * (1.0 - turned)};
    // std::complex<double> is laid out as two doubles ([complex.numbers]/4).
    delay_spectrum(delay,
                   angle_.data(),
                   kernel_difference_.data(),
                   spectrum.size(),
                   reinterpret_cast<double*>(spectrum.data()));
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
