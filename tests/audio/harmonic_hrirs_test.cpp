// SPDX-License-Identifier: MIT
#include "earshot/audio/harmonic_hrirs.h"

#include "earshot/audio/spatial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace earshot::audio {
namespace {

constexpr double kRate = 48000.0;

/// Two ears 0.17 m apart without a head: delays alone, as impulses at whole samples of a grid of
/// directions.
HrirSet bare_ears() {
    HrirSet set{.sample_rate = kRate};
    for (int elevation = -80; elevation <= 80; elevation += 20) {
        for (int azimuth = 0; azimuth < 360; azimuth += 20) {
            const double up = elevation * std::numbers::pi / 180.0;
            const double around = azimuth * std::numbers::pi / 180.0;
            Hrir hrir{.towards = {std::cos(up) * std::cos(around),
                                  std::cos(up) * std::sin(around),
                                  std::sin(up)}};
            const double early = 0.085 * hrir.towards[1] / 343.2 * kRate;
            hrir.left.assign(64, 0.0);
            hrir.right.assign(64, 0.0);
            hrir.left[static_cast<std::size_t>(std::lround(20.0 - early))] = 1.0;
            hrir.right[static_cast<std::size_t>(std::lround(20.0 + early))] = 1.0;
            set.directions.push_back(hrir);
        }
    }
    set.centre_delay = 20.0 / kRate;
    return set;
}

/// What an ear hears of a plane wave, at a frequency: magnitude, and delay beyond the latency.
struct Heard {
    double magnitude = 0.0, delay = 0.0;
};
Heard hear(const HarmonicHrirs& hrirs,
           std::size_t ear,
           int order,
           const std::array<double, 3>& towards,
           double frequency) {
    std::vector<double> harmonics(ambisonic_channels(order));
    spherical_harmonics(order, towards, harmonics);
    double re = 0.0, im = 0.0;
    for (std::size_t channel = 0; channel < harmonics.size(); ++channel) {
        const std::vector<double>& taps = hrirs.ears[ear][channel];
        for (std::size_t n = 0; n < taps.size(); ++n) {
            const double angle = 2.0 * std::numbers::pi * frequency / kRate *
                                 (static_cast<double>(n) - static_cast<double>(hrirs.latency));
            re += harmonics[channel] * taps[n] * std::cos(angle);
            im -= harmonics[channel] * taps[n] * std::sin(angle);
        }
    }
    return {std::hypot(re, im), -std::atan2(im, re) / (2.0 * std::numbers::pi * frequency)};
}

// Low frequencies have their delays, all of them about the magnitude 1 of ears without a head.
TEST(HarmonicHrirs, KeepDelaysBelowAndMagnitudesAbove) {
    constexpr int kOrder = 3;
    const HarmonicHrirs hrirs = harmonic_hrirs(HrirInterpolator(bare_ears()), kOrder);
    for (const double side : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const std::array<double, 3> towards = {std::sqrt(1.0 - side * side), side, 0.0};
        for (std::size_t ear = 0; ear < 2; ++ear) {
            const double early = (ear == 0 ? 1.0 : -1.0) * 0.085 * side / 343.2;
            const Heard low = hear(hrirs, ear, kOrder, towards, 500.0);
            EXPECT_NEAR(low.magnitude, 1.0, 0.02) << side;
            EXPECT_NEAR(low.delay, -early, 1.5e-5) << side;
            for (const double frequency : {4000.0, 8000.0}) {
                EXPECT_NEAR(hear(hrirs, ear, kOrder, towards, frequency).magnitude, 1.0, 0.2)
                    << side << ", " << frequency << " Hz";
            }
        }
    }
}

}  // namespace
}  // namespace earshot::audio
