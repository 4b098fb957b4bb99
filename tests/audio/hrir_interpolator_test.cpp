// SPDX-License-Identifier: MIT
#include "earshot/audio/hrir_interpolator.h"

#include "earshot/audio/binaural.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace earshot::audio {
namespace {

constexpr double kRate = 44100.0;
constexpr double kCentre = 50.3;                    // samples
constexpr double kRadius = 0.0875 / 343.2 * kRate;  // samples
constexpr double kHalfWidth = 2.5;                  // samples, of a pulse

using Vector = std::array<double, 3>;

Vector at(double azimuth_degrees, double elevation_degrees) {
    const double azimuth = azimuth_degrees * std::numbers::pi / 180.0;
    const double elevation = elevation_degrees * std::numbers::pi / 180.0;
    return {std::cos(elevation) * std::cos(azimuth),
            std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

// Woodworth's delay of a sphere, in samples, at the ear on the left (1) or the right (-1).
double delay_of(const Vector& towards, int side) {
    const double angle = std::acos(std::max(-1.0, std::min(1.0, side * towards[1])));
    return angle <= std::numbers::pi / 2.0 ? -kRadius * std::cos(angle)
                                           : kRadius * (angle - std::numbers::pi / 2.0);
}

double gain_of(const Vector& towards, int side) {
    return 1.0 + 0.6 * side * towards[1] + 0.2 * towards[2];
}

// A bell, band-limited for all that matters, at the delay of a spherical head.
std::vector<double> pulse(const Vector& towards, int side, double distance) {
    std::vector<double> samples(128);
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const double t = (static_cast<double>(n) - kCentre - delay_of(towards, side)) / kHalfWidth;
        samples[n] = gain_of(towards, side) / distance * std::exp(-0.5 * t * t);
    }
    return samples;
}

HrirSet spherical_head(double step, double distance = 1.0) {
    HrirSet set{.sample_rate = kRate, .directions{}, .centre_delay = 0.0};
    for (double elevation = -90.0; elevation <= 90.0; elevation += step) {
        for (double azimuth = 0.0; azimuth < 360.0; azimuth += step) {
            const Vector towards = at(azimuth, elevation);
            set.directions.push_back({.towards = towards,
                                      .left = pulse(towards, 1, distance),
                                      .right = pulse(towards, -1, distance),
                                      .distance = distance});
        }
    }
    return set;
}

std::complex<double> transform_at(const InterpolatedHrir& hrir, std::size_t ear, double hz) {
    std::complex<double> sum = 0.0;
    for (std::size_t n = 0; n < hrir.ears[ear].size(); ++n) {
        const double sample = static_cast<double>(n) + static_cast<double>(hrir.begin);
        sum += std::polar(hrir.ears[ear][n], -2.0 * std::numbers::pi * hz / kRate * sample);
    }
    return sum;
}

// The transform of a pulse of unit gain.
double pulse_at(double hz) {
    const double phase = 2.0 * std::numbers::pi * hz / kRate * kHalfWidth;
    return std::sqrt(2.0 * std::numbers::pi) * kHalfWidth * std::exp(-0.5 * phase * phase);
}

// Delay and gain between directions are those of the sphere, to what a linear change over a cell
// of 5 degrees can follow.
TEST(HrirInterpolator, FollowsASphericalHead) {
    HrirSet set = spherical_head(5.0);
    set.centre_delay = kCentre / kRate;
    const HrirInterpolator interpolator(set);
    for (std::uint64_t i = 0; i < 300; ++i) {
        const double sine = random_between(1, 0, i, -1.0, 1.0);
        const Vector towards =
            at(random_between(1, 1, i, 0.0, 360.0), std::asin(sine) * 180.0 / std::numbers::pi);
        const InterpolatedHrir hrir = interpolator.at(towards);
        for (const int side : {1, -1}) {
            const auto value = transform_at(hrir, side == 1 ? 0 : 1, 500.0);
            EXPECT_NEAR(std::abs(value) / (pulse_at(500.0) * gain_of(towards, side)), 1.0, 0.004);
            const double samples = -std::arg(value) / (2.0 * std::numbers::pi * 500.0) * kRate;
            // The delay has a cusp opposite the ear, which a cell of 5 degrees rounds off.
            const double tolerance = side * towards[1] < -0.99 ? 0.5 : 0.06;
            EXPECT_NEAR(samples, delay_of(towards, side), tolerance) << side * towards[1];
        }
    }
}

// Halfway between directions whose delays differ by whole periods of a high frequency nothing
// cancels, as it would if the responses were added as they are.
TEST(HrirInterpolator, KeepsHighFrequenciesBetweenDirectionsFarApart) {
    const HrirInterpolator interpolator(spherical_head(30.0));
    const double hz = 7000.0;
    const Vector between = at(15.0, 0.0);
    const double level = std::abs(transform_at(interpolator.at(between), 0, hz));
    EXPECT_NEAR(level / pulse_at(hz), gain_of(between, 1), 0.02);
}

TEST(HrirInterpolator, HasTheResponsesOfAMeasuredDirection) {
    const HrirSet set = spherical_head(15.0);
    const HrirInterpolator interpolator(set);
    for (const Hrir& measured : set.directions) {
        if (std::abs(measured.towards[2]) > 0.999) {
            continue;  // a pole is measured many times
        }
        const InterpolatedHrir hrir = interpolator.at(measured.towards);
        EXPECT_EQ(hrir.begin, 0);
        EXPECT_EQ(hrir.ears[0], measured.left);
        EXPECT_EQ(hrir.ears[1], measured.right);
    }
}

TEST(HrirInterpolator, TakesTheLargestDistanceInAnyOrder) {
    const std::array<double, 4> distances{0.2, 0.5, 1.0, 2.0};
    for (const bool reversed : {false, true}) {
        HrirSet all{.sample_rate = kRate, .directions{}, .centre_delay = 0.0};
        for (std::size_t k = 0; k < 4; ++k) {
            const HrirSet one = spherical_head(15.0, distances[reversed ? 3 - k : k]);
            all.directions.insert(
                all.directions.end(), one.directions.begin(), one.directions.end());
        }
        const HrirInterpolator interpolator(all);
        const HrirInterpolator far(spherical_head(15.0, 2.0));
        for (double azimuth = 0.0; azimuth < 360.0; azimuth += 10.0) {
            EXPECT_EQ(interpolator.at(at(azimuth, 0.0)).ears, far.at(at(azimuth, 0.0)).ears);
        }
    }
}

TEST(HrirInterpolator, IsContinuous) {
    const HrirInterpolator interpolator(spherical_head(15.0));
    for (double azimuth = 0.0; azimuth < 360.0; azimuth += 5.0) {
        const auto one = transform_at(interpolator.at(at(azimuth - 5e-4, 10.0)), 0, 3000.0);
        const auto other = transform_at(interpolator.at(at(azimuth + 5e-4, 10.0)), 0, 3000.0);
        EXPECT_LT(std::abs(one - other), 2e-3 * std::abs(one)) << azimuth;
    }
}

TEST(HrirInterpolator, LeavesOutSilentResponses) {
    HrirSet set = spherical_head(30.0);
    for (Hrir& measured : set.directions) {
        measured.right.assign(128, 0.0);
    }
    const InterpolatedHrir hrir = HrirInterpolator(set).at(at(17.0, 5.0));
    EXPECT_GT(std::abs(transform_at(hrir, 0, 0.0)), 1.0);
    EXPECT_EQ(std::abs(transform_at(hrir, 1, 0.0)), 0.0);
}

TEST(HrirInterpolator, RefusesAnEmptySet) {
    EXPECT_THROW(HrirInterpolator(HrirSet{}), Error);
}

// The spectrum between the ears of an arrival is that of the HRIR, at the instant of the arrival.
TEST(RenderBinaural, BringsAnArrivalToTheHeadsCentreInTime) {
    HrirSet set = spherical_head(10.0);
    set.centre_delay = kCentre / kRate;
    const HrirInterpolator interpolator(set);
    const Assembler assembler(Bands::octaves(), kRate);
    for (const double metres : {0.2, 2.0, 20.0}) {
        Arrival arrival;
        arrival.delay = metres / 343.2;
        arrival.pressure.fill(1.0 / metres);
        arrival.direction = {-1.0, 0.0, 0.0};
        const auto ears = render_binaural(assembler, std::span(&arrival, 1), interpolator);
        for (const ImpulseResponse& ear : ears) {
            const InterpolatedHrir heard{0, {ear.samples, ear.samples}};
            const auto value = transform_at(heard, 0, 100.0) *
                               std::polar(1.0, 2.0 * std::numbers::pi * 100.0 * metres / 343.2);
            EXPECT_NEAR(std::abs(value) * metres / pulse_at(100.0), 1.0, 1e-3) << metres;
            EXPECT_NEAR(std::arg(value) / (2.0 * std::numbers::pi * 100.0), 0.0, 5e-6) << metres;
        }
    }
}

TEST(RenderBinaural, IsTheSameForAnyNumberOfThreads) {
    const HrirInterpolator interpolator(spherical_head(30.0));
    const Assembler assembler(Bands::octaves(), kRate);
    std::vector<Arrival> arrivals(150);
    for (std::uint64_t i = 0; i < arrivals.size(); ++i) {
        arrivals[i].delay = 0.1 * random(2, 0, i);
        arrivals[i].pressure.fill(random(2, 1, i));
        arrivals[i].direction = at(360.0 * random(2, 2, i), 60.0 * random(2, 3, i));
    }
    Executor two(2);
    const auto one = render_binaural(assembler, arrivals, interpolator, {}, 0.15);
    const auto other = render_binaural(assembler, arrivals, interpolator, {}, 0.15, two);
    EXPECT_EQ(one[0].samples, other[0].samples);
    EXPECT_EQ(one[1].samples, other[1].samples);
    EXPECT_EQ(one[0].samples.size(), 6615U);
}

TEST(RenderBinaural, RefusesArrivalsThatAreNone) {
    const HrirInterpolator interpolator(spherical_head(30.0));
    const Assembler assembler(Bands::octaves(), kRate);
    for (const double delay : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        Arrival arrival;
        arrival.delay = delay;
        arrival.pressure.fill(1.0);
        EXPECT_THROW(render_binaural(assembler, std::span(&arrival, 1), interpolator), Error);
    }
}

}  // namespace
}  // namespace earshot::audio
