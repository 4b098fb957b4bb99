// SPDX-License-Identifier: MIT
#include "earshot/audio/moving_arrivals.h"

#include "earshot/audio/convolve.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <tuple>
#include <vector>

namespace earshot::audio {
namespace {

constexpr double kRate = 48000.0;
constexpr double kSpeedOfSound = 343.2;
constexpr double kFrequency = 1000.0;

/// A source that passes a listener at the origin on a straight line, at constant speed. What is
/// heard at t was emitted at t - delay(t), where |D - v delay| = c delay with D the source's place
/// at t: a quadratic equation.
struct Pass {
    double speed = 0.0;    ///< metres per second
    double nearest = 0.0;  ///< metres
    double time_of = 0.0;  ///< seconds, of the nearest point

    double delay(double t) const {
        const double x = speed * (t - time_of);
        const double a = kSpeedOfSound * kSpeedOfSound - speed * speed;
        const double along = x * speed;
        return (-along + std::sqrt(along * along + a * (x * x + nearest * nearest))) / a;
    }
    /// d delay / dt, from the derivative of |D - v delay|^2 = c^2 delay^2.
    double rate(double t) const {
        const double x = speed * (t - time_of - delay(t));  // at the emission
        const double towards = x * speed / (kSpeedOfSound * kSpeedOfSound * delay(t));
        return towards / (1.0 + towards);
    }
};

std::vector<double> tone(double phase, std::size_t size) {
    std::vector<double> samples;
    for (std::size_t n = 0; n < size; ++n) {
        const double t = static_cast<double>(n) / kRate;
        samples.push_back(std::cos(2.0 * math::kPi * kFrequency * t - phase));
    }
    return samples;
}

/// What the listener hears of a signal, by stretches of `stretch` samples.
std::vector<double> rendered(const Pass& pass,
                             const std::vector<double>& signal,
                             std::size_t stretch) {
    std::vector<double> heard(signal.size(), 0.0);
    const double one = 1.0;
    const auto at = [&](std::size_t n) {
        const double t = static_cast<double>(n) / kRate;
        return MovingArrival{
            .delay = pass.delay(t), .delay_rate = pass.rate(t), .gains = {&one, 1}};
    };
    for (std::size_t n = 0; n + stretch <= signal.size(); n += stretch) {
        add_moving_arrival({.sample_rate = kRate, .speed_of_sound = kSpeedOfSound},
                           signal,
                           static_cast<double>(n),
                           at(n),
                           at(n + stretch),
                           stretch,
                           stretch,
                           &heard[n]);
    }
    return heard;
}

// Issue: approach at 10 m/s was heard at 978 Hz for 1030 Hz, and its envelope fell to a quarter.
TEST(MovingArrivals, AreHeardAtTheFrequencyAndLevelOfTheirEmission) {
    constexpr std::size_t kSize = 36000;
    for (const double speed : {1.0, 10.0, 30.0}) {
        for (const double nearest : {0.3, 3.0}) {
            for (const double time_of : {0.4, 2.0}) {  // passes, approaches
                const Pass pass{speed, nearest, time_of};
                // Cosine and sine together are the analytic signal.
                const auto re = rendered(pass, tone(0.0, kSize), 64);
                const auto im = rendered(pass, tone(0.5 * math::kPi, kSize), 64);
                std::complex<double> last;
                for (std::size_t n = 9600; n + 64 < kSize; ++n) {
                    const double t = static_cast<double>(n) / kRate;
                    const double distance = kSpeedOfSound * pass.delay(t);
                    const std::complex<double> heard(re[n], im[n]);
                    ASSERT_NEAR(20.0 * std::log10(std::abs(heard) * distance), 0.0, 0.001)
                        << speed << " m/s, " << nearest << " m, " << t;
                    if (n > 9600) {
                        const double turn = std::arg(heard * std::conj(last));
                        const double middle = t - 0.5 / kRate;
                        const double expected = kFrequency * (1.0 - pass.rate(middle));
                        ASSERT_NEAR(turn * kRate / (2.0 * math::kPi), expected, 1e-4 * expected)
                            << speed << " m/s, " << nearest << " m, " << t;
                    }
                    last = heard;
                }
            }
        }
    }
}

// All that differs from the tone that should be heard is below -80 dB, so any line of its spectrum.
TEST(MovingArrivals, HaveNoLinesBesideTheTone) {
    constexpr std::size_t kSize = 48000;
    for (const double speed : {1.0, 10.0, 30.0}) {
        const Pass pass{speed, 3.0, 0.5};
        const auto heard = rendered(pass, tone(0.0, kSize), 64);
        for (std::size_t n = 9600; n + 64 < kSize; ++n) {
            const double t = static_cast<double>(n) / kRate;
            const double delay = pass.delay(t);
            const double expected = std::cos(2.0 * math::kPi * kFrequency * (t - delay));
            ASSERT_NEAR(heard[n] * kSpeedOfSound * delay, expected, 1e-5) << speed << " " << t;
        }
    }
}

TEST(MovingArrivals, NeedNoFineStretches) {
    constexpr std::size_t kSize = 36864;
    const Pass pass{30.0, 1.0, 0.5};
    const auto signal = tone(0.0, kSize);
    const auto fine = rendered(pass, signal, 32);
    const auto coarse = rendered(pass, signal, 256);
    for (std::size_t n = 9600; n + 256 < kSize; ++n) {
        ASSERT_NEAR(fine[n], coarse[n], 1e-4 * (1.0 + std::abs(fine[n]))) << n;
    }
}

TEST(MovingArrivals, AreSilentBeforeAndAfterTheSignal) {
    const std::vector<double> signal(400, 1.0);
    const double one = 1.0;
    const MovingArrival arrival{.delay = 1.0 / kSpeedOfSound, .gains = {&one, 1}};
    std::vector<double> bus(64, 0.0);
    for (const double now : {-1e9, -300.0, 1000.0, 1e9}) {
        add_moving_arrival({.sample_rate = kRate, .speed_of_sound = kSpeedOfSound},
                           signal,
                           now,
                           arrival,
                           arrival,
                           64,
                           64,
                           bus.data());
    }
    EXPECT_EQ(bus, std::vector<double>(64, 0.0));
}

TEST(MovingArrivals, PassThroughTheListenerWithFiniteLevels) {
    const auto heard = rendered({10.0, 0.0, 0.1003}, tone(0.0, 9600), 64);
    for (const double sample : heard) {
        ASSERT_LE(std::abs(sample), 1001.0);
    }
}

std::vector<double> noise(std::size_t size) {
    std::vector<double> samples;
    for (std::uint64_t n = 0; n < size; ++n) {
        samples.push_back(random(7, 0, n) - 0.5);
    }
    return samples;
}

Spectrum slope(double first, double last) {
    Spectrum spectrum{};
    for (std::size_t band = 0; band < Bands::octaves().count(); ++band) {
        spectrum[band] = first + (last - first) * static_cast<double>(band) / 9.0;
    }
    return spectrum;
}

// Arrivals that stand still make the response that the assembler makes of them.
TEST(MovingArrivalRenderer, PlaysTheResponseOfArrivalsThatStandStill) {
    const Assembler assembler(Bands::octaves(), kRate);
    const std::vector<Arrival> arrivals = {
        {.delay = 0.0104, .pressure = slope(0.3, 0.2)},
        {.delay = 0.0211, .pressure = slope(0.2, 0.05)},
        {.delay = 0.0333, .pressure = slope(0.1, 0.1), .is_inverted = true}};
    std::vector<Spectrum> spectra;
    for (const Arrival& arrival : arrivals) {
        Spectrum at_1_m = arrival.pressure;
        for (double& p : at_1_m) {
            p *= arrival.delay * kSpeedOfSound * (arrival.is_inverted ? -1.0 : 1.0);
        }
        spectra.push_back(at_1_m);
    }
    const FilterBank bank(assembler, spectra);

    constexpr std::size_t kBlock = 256;
    const auto signal = noise(40 * kBlock);
    MovingArrivalRenderer renderer(
        bank,
        {.scale = {.sample_rate = kRate, .speed_of_sound = kSpeedOfSound},
         .max_delay = 0.04,
         .block = kBlock});
    std::vector<double> heard(signal.size());
    for (std::size_t begin = 0; begin < signal.size(); begin += kBlock) {
        renderer.begin_block(std::span(signal).subspan(begin, kBlock));
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            const MovingArrival arrival{.delay = arrivals[i].delay, .gains = bank.weights(i)};
            renderer.add(arrival, arrival, 0, 100);
            renderer.add(arrival, arrival, 100, kBlock - 100);
        }
        renderer.end_block(std::span(heard).subspan(begin, kBlock));
    }
    const auto expected = convolve(signal, assembler.assemble(arrivals).samples);
    for (std::size_t n = kMovingArrivalLookahead; n < heard.size(); ++n) {
        ASSERT_NEAR(heard[n], expected[n - kMovingArrivalLookahead], 2e-5) << n;
    }
}

// A renderer that plays blocks gives what the whole signal gives, late by the look-ahead.
TEST(MovingArrivalRenderer, MovesAsTheWholeSignalDoes) {
    const Assembler assembler(Bands::octaves(), kRate);
    const std::vector<Spectrum> flat = {slope(1.0, 1.0)};
    const FilterBank bank(assembler, flat);
    ASSERT_EQ(bank.filters(), 1U);
    constexpr std::size_t kBlock = 128;
    const Pass pass{20.0, 3.0, 0.2};
    const auto signal = noise(200 * kBlock);
    const auto whole = rendered(pass, signal, kBlock);
    MovingArrivalRenderer renderer(
        bank,
        {.scale = {.sample_rate = kRate, .speed_of_sound = kSpeedOfSound},
         .max_delay = 0.1,
         .block = kBlock});
    const auto at = [&](std::size_t n) {
        const double t =
            (static_cast<double>(n) - static_cast<double>(kMovingArrivalLookahead)) / kRate;
        return MovingArrival{
            .delay = pass.delay(t), .delay_rate = pass.rate(t), .gains = bank.weights(0)};
    };
    std::vector<double> block(kBlock);
    for (std::size_t begin = 0; begin < signal.size(); begin += kBlock) {
        renderer.begin_block(std::span(signal).subspan(begin, kBlock));
        renderer.add(at(begin), at(begin + kBlock), 0, kBlock);
        renderer.end_block(block);
        for (std::size_t n = 0; n < kBlock; ++n) {
            if (begin + n >= kMovingArrivalLookahead) {
                ASSERT_NEAR(block[n], whole[begin + n - kMovingArrivalLookahead], 1e-5)
                    << begin + n;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::audio
