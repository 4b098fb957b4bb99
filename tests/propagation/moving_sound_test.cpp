// SPDX-License-Identifier: MIT
#include "earshot/propagation/moving_sound.h"

#include "earshot/audio/convolve.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/propagation/response.h"

#include <gtest/gtest.h>

#include "support/moving_images.h"
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kRate = 48000.0;
constexpr double kFrequency = 1000.0;

Scene box(double absorption) {
    return test::PassingSource().scene(absorption);
}
Trajectory pass(double speed, double seconds) {
    const test::PassingSource source{.speed = speed};
    return Trajectory({{0.0, source.place(0.0)}, {seconds, source.place(seconds)}});
}

std::vector<double> tone(double seconds) {
    std::vector<double> samples;
    for (std::size_t n = 0; n < static_cast<std::size_t>(seconds * kRate); ++n) {
        const double t = static_cast<double>(n) / kRate;
        samples.push_back(std::sin(2.0 * std::numbers::pi * kFrequency * t));
    }
    return samples;
}

std::vector<double> noise(double seconds) {
    std::vector<double> samples;
    for (std::uint64_t n = 0; n < static_cast<std::uint64_t>(seconds * kRate); ++n) {
        samples.push_back(random(3, 0, n) - 0.5);
    }
    return samples;
}

/// The sum over all images up to an order.
double heard_of_images(double speed, double t, int order, double reflection) {
    double sum = 0.0;
    for (const auto& image : test::PassingSource{.speed = speed}.images(t, order, reflection)) {
        sum += image.pressure * std::sin(2.0 * std::numbers::pi * kFrequency * image.emission);
    }
    return sum;
}

// All that is heard, against the sum over images, sample by sample: whatever differs, in frequency,
// in level or as a line of its own, is 80 dB below the direct sound.
TEST(MovingSound, IsThatOfTheMovingImages) {
    const Scene scene = box(0.19);
    for (const double speed : {1.0, 10.0, 30.0}) {
        const MovingPair pair{.source_path = pass(speed, 0.9)};
        const MovingSound sound = render_moving_pair(
            scene, {.specular_order = 2, .air_absorption = false}, {}, pair, tone(0.9));
        EXPECT_EQ(sound.paths, 25U);
        const std::vector<double>& heard = sound.signal.channels.front();
        const double level = 1.0 / 3.0;
        for (std::size_t n = 19200; n < 42000; n += 7) {
            const double t = static_cast<double>(n) / kRate;
            const double expected = heard_of_images(speed, t, 2, 0.9);
            ASSERT_NEAR(heard[n], expected, 1e-4 * level) << speed << " m/s, " << t;
        }
    }
}

double energy(std::span<const double> samples) {
    double sum = 0.0;
    for (const double sample : samples) {
        sum += sample * sample;
    }
    return sum;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(std::max(a.size(), b.size()), 0.0);
    for (std::size_t n = 0; n < a.size(); ++n) {
        result[n] += a[n];
    }
    for (std::size_t n = 0; n < b.size(); ++n) {
        result[n] -= b[n];
    }
    return result;
}

// 10 m/s, nearest at 3 m, with air and materials that differ from band to band.
TEST(MovingSound, DoesNotDependOnTheStep) {
    Scene scene = box(0.19);
    scene.materials[0].absorption = EnergyCoefficient({{125.0, 0.1}, {8000.0, 0.6}});
    for (const auto& recording : {tone(0.8), noise(0.8)}) {
        std::vector<std::vector<double>> heard;
        for (const double step : {0.01, 0.1}) {
            const MovingPair pair{.source_path = pass(10.0, 0.8), .step = step};
            heard.push_back(render_moving_pair(scene, {.specular_order = 2}, {}, pair, recording)
                                .signal.channels.front());
        }
        const double level =
            10.0 * std::log10(energy(difference(heard[0], heard[1])) / energy(heard[0]));
        EXPECT_LT(level, -60.0);
        RecordProperty("difference_db", std::to_string(level));
    }
}

/// The largest difference, relative to the largest sample.
double deviation(const std::vector<double>& found, const std::vector<double>& expected) {
    double largest = 0.0, off = 0.0;
    for (const double sample : expected) {
        largest = std::max(largest, std::abs(sample));
    }
    for (const double sample : difference(found, expected)) {
        off = std::max(off, std::abs(sample));
    }
    return off / largest;
}

// Where nothing moves it is the convolution with the response, late sound included.
TEST(MovingSound, IsTheResponseWhereNothingMoves) {
    Scene scene = box(0.5);
    scene.listeners[0].looks_at = Vec3(0.0, 2.0, 20.0);
    const Options simulation{
        .specular_order = 1, .rays = 1000, .late_length = 0.2, .late_directions = true};
    const auto recording = noise(0.3);
    for (const ResponseFormat& format :
         {ResponseFormat{},
          ResponseFormat{.channels = Channels::ambisonic, .ambisonic_order = 2},
          ResponseFormat{.channels = Channels::binaural, .hrir_set = io::default_hrir_set()}}) {
        Simulator simulator(scene, simulation);
        const PairResult pair = std::move(simulator.run().front());
        const Response response =
            render_response(simulation.bands, pair, scene.pose_at(scene.listeners[0], 0.0), format);
        const MovingSound sound = render_moving_pair(
            scene, simulation, format, {.step = 0.1, .late_step = 0.2}, recording);
        ASSERT_EQ(sound.signal.channels.size(), response.channels.size());
        EXPECT_EQ(sound.late_instants, 3U);
        for (std::size_t channel = 0; channel < response.channels.size(); ++channel) {
            const auto expected = audio::convolve(recording, response.channels[channel].samples);
            EXPECT_LT(deviation(sound.signal.channels[channel], expected), 1e-4)
                << "format " << static_cast<int>(format.channels) << " channel " << channel;
        }
    }
}

TEST(MovingSound, HasTheSameBitsForAnyThreads) {
    const Scene scene = box(0.3);
    const auto recording = noise(0.4);
    const MovingPair pair{.source_path = pass(20.0, 0.5), .late_step = 0.2};
    const Options simulation{.specular_order = 2, .rays = 500, .late_length = 0.1};
    Executor four(4);
    const auto serial = render_moving_pair(scene, simulation, {}, pair, recording);
    const auto parallel = render_moving_pair(scene, simulation, {}, pair, recording, four);
    EXPECT_EQ(serial.signal.channels, parallel.signal.channels);
}

TEST(MovingSound, RefusesWhatIsFasterThanSound) {
    const Scene scene = box(0.3);
    const auto recording = noise(0.1);
    EXPECT_THROW(render_moving_pair(scene, {}, {}, {.source_path = pass(330.0, 0.1)}, recording),
                 Error);
    EXPECT_THROW(render_moving_pair(scene, {}, {}, {.step = 0.0}, recording), Error);
    EXPECT_THROW(render_moving_pair(scene, {}, {}, {.late_step = -1.0}, recording), Error);
}

}  // namespace
}  // namespace earshot::propagation
