// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/short_delay.h"

#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::audio {

namespace {

// With 24 taps the largest error of any fraction up to 18 kHz at 48 kHz is smallest here: -87 dB.
constexpr double kBeta = 9.375;
constexpr double kHalf = static_cast<double>(kShortDelayTaps) / 2.0;

double sinc(double t) {
    const double angle = math::kPi * t;
    return t == 0.0 ? 1.0 : math::sin(angle) / angle;
}

std::array<double, kShortDelayTaps> taps_of(double fraction) {
    std::array<double, kShortDelayTaps> taps{};
    double sum = 0.0;
    for (std::size_t tap = 0; tap < kShortDelayTaps; ++tap) {
        const double t = static_cast<double>(tap) - static_cast<double>(kShortDelayLead) - fraction;
        const double inside = std::max(1.0 - (t / kHalf) * (t / kHalf), 0.0);
        taps[tap] = sinc(t) * bessel_i0(kBeta * std::sqrt(inside));
        sum += taps[tap];
    }
    for (double& tap : taps) {
        tap /= sum;
    }
    return taps;
}

}  // namespace

ShortDelayTable::ShortDelayTable() {
    for (std::size_t k = 0; k <= kShortDelayFractions; ++k) {
        const auto taps =
            taps_of(static_cast<double>(k) / static_cast<double>(kShortDelayFractions));
        for (const double tap : taps) {
            rows_.push_back(static_cast<float>(tap));
        }
    }
}

const ShortDelayTable& ShortDelayTable::shared() {
    static const ShortDelayTable table;
    return table;
}

}  // namespace earshot::audio
