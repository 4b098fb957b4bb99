// SPDX-License-Identifier: MIT
// Directions of sound over paths of frames.
#include "earshot/base/random.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/propagation/path_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kRate = 48000.0;
constexpr double kSpeedOfSound = 343.2;
constexpr double kRadius = 5.0;
constexpr double kElevation = 0.4;
constexpr double kStep = 0.025;
const Vec3 kListener(1.0, 2.0, 3.0);

/// A direction whose azimuth is clockwise from -Z, seen from above.
Vec3 direction(double azimuth, double elevation) {
    return {std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation),
            -std::cos(elevation) * std::cos(azimuth)};
}

/// A source around the listener in the free field, at azimuths that change as their listener's.
struct Turn {
    double source = 0.0, source_rate = 0.0;      // radians, radians per second
    double listener = 0.0, listener_rate = 0.0;  // likewise
    double elevation = kElevation;

    PathFrames frames(double seconds) const {
        PathFrames frames{.name = "frames", .speed_of_sound = kSpeedOfSound};
        for (int k = 0; k <= static_cast<int>(seconds / kStep + 0.5); ++k) {
            const double time = kStep * k;
            const Vec3 at = kListener + kRadius * direction(source + source_rate * time, elevation);
            Path path{.points = {at, kListener}};
            path.pressure.fill(1.0 / kRadius);
            frames.instants.push_back(
                {.time = time,
                 .paths = {path},
                 .listener_front = direction(listener + listener_rate * time, 0.0)});
        }
        return frames;
    }
};

double tone(double t) {
    return std::sin(2.0 * std::numbers::pi * 700.0 * t);
}

// The first-order channels of a plane wave are its pressure times the components of the direction
// from which it comes, at the instant of emission relative to how the listener is turned when it
// arrives.
TEST(PathFramesDirections, FirstOrderChannelsFollowTheAngle) {
    const std::size_t count = static_cast<std::size_t>(kRate);
    std::vector<double> recording(count);
    for (std::size_t n = 0; n < count; ++n) {
        recording[n] = tone(static_cast<double>(n) / kRate);
    }
    const ResponseFormat format{
        .channels = Channels::ambisonic, .ambisonic_order = 1, .sample_rate = kRate};
    for (const Turn& turn : {Turn{.source = -1.0, .source_rate = 2.0},
                             Turn{.source = 0.7, .listener = 0.3, .listener_rate = 2.0},
                             Turn{.source_rate = 1.5, .listener = 2.0, .listener_rate = -1.0}}) {
        const MovingSound sound = render_path_frames(turn.frames(1.0), format, recording);
        ASSERT_EQ(sound.signal.channels.size(), 4U);
        for (std::size_t n = 2000; n < count - 2000; n += 7) {
            const double t = static_cast<double>(n) / kRate;
            const double emission = t - kRadius / kSpeedOfSound;
            const double azimuth =
                turn.source + turn.source_rate * emission - turn.listener - turn.listener_rate * t;
            const double pressure = tone(emission) / kRadius;
            const std::array<double, 4> expected = {
                pressure,
                -pressure * std::cos(kElevation) * std::sin(azimuth),
                pressure * std::sin(kElevation),
                pressure * std::cos(kElevation) * std::cos(azimuth)};
            for (std::size_t channel = 0; channel < 4; ++channel) {
                ASSERT_NEAR(sound.signal.channels[channel][n], expected[channel], 1e-4 / kRadius)
                    << "channel " << channel << ", " << t << " s";
            }
        }
    }
}

/// What two ears hear of a stretch.
struct EarDifference {
    double level_db = 0.0;  // of the left ear above the right
    double delay = 0.0;     // seconds by which the right ear is later
};

EarDifference difference_of(const audio::Signal& signal, std::size_t begin, std::size_t count) {
    constexpr int kMaxLag = 60;
    std::array<double, 2> energy{};
    double best = 0.0;
    int lag = 0;
    for (int shift = -kMaxLag; shift <= kMaxLag; ++shift) {
        double sum = 0.0;
        for (std::size_t n = begin; n < begin + count; ++n) {
            sum += signal.channels[0][n] *
                   signal.channels[1][static_cast<std::size_t>(static_cast<int>(n) + shift)];
        }
        if (sum > best) {
            best = sum;
            lag = shift;
        }
    }
    for (std::size_t ear = 0; ear < 2; ++ear) {
        for (std::size_t n = begin; n < begin + count; ++n) {
            energy[ear] += signal.channels[ear][n] * signal.channels[ear][n];
        }
    }
    return {.level_db = 10.0 * std::log10(energy[0] / energy[1]), .delay = lag / kRate};
}

// From left to right in front of the listener: the differences between the ears change their signs
// as the source passes the middle. The time is about that of a sphere of the head's size
// (Woodworth 1938): radius / c (azimuth + sin azimuth).
TEST(PathFramesDirections, EarsHearFromWhichSide) {
    constexpr double kHead = 0.0875;  // metres
    const Turn turn{.source = -1.2, .source_rate = 2.4, .elevation = 0.0};
    std::vector<double> recording(static_cast<std::size_t>(kRate));
    for (std::uint64_t n = 0; n < recording.size(); ++n) {
        recording[n] = random(5, 0, n) - 0.5;
    }
    const MovingSound sound = render_path_frames(
        turn.frames(1.0),
        {.channels = Channels::binaural, .hrir_set = io::default_hrir_set(), .sample_rate = kRate},
        recording);
    ASSERT_EQ(sound.signal.channels.size(), 2U);
    constexpr std::size_t kStretch = 2048;
    int sides = 0;
    for (std::size_t begin = 2048; begin + 2 * kStretch < recording.size(); begin += kStretch) {
        const double middle = static_cast<double>(begin + kStretch / 2) / kRate;
        const double azimuth = turn.source + turn.source_rate * (middle - kRadius / kSpeedOfSound);
        if (std::abs(azimuth) < 0.25) {
            continue;
        }
        const EarDifference heard = difference_of(sound.signal, begin, kStretch);
        const double side = azimuth < 0.0 ? 1.0 : -1.0;  // 1: left
        const double sphere =
            kHead / kSpeedOfSound * (std::abs(azimuth) + std::sin(std::abs(azimuth)));
        EXPECT_GT(side * heard.level_db, 1.0) << azimuth;
        EXPECT_GT(side * heard.delay, 0.6 * sphere) << azimuth;
        EXPECT_LT(side * heard.delay, 1.6 * sphere) << azimuth;
        sides += side > 0.0 ? 1 : 100;
    }
    EXPECT_GT(sides % 100, 5);
    EXPECT_GT(sides / 100, 5);
}

}  // namespace
}  // namespace earshot::propagation
