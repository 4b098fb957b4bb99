// SPDX-License-Identifier: MIT
#include "earshot/audio/hrir_set.h"

#include "earshot/audio/diffuse_field.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace earshot::audio {
namespace {

using Vector = std::array<double, 3>;

std::complex<double> transform(const std::vector<double>& samples, double cycles) {
    std::complex<double> sum = 0.0;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        sum += std::polar(samples[n], -2.0 * std::numbers::pi * cycles * static_cast<double>(n));
    }
    return sum;
}

Vector at(double azimuth_degrees, double elevation_degrees) {
    const double azimuth = azimuth_degrees * std::numbers::pi / 180.0;
    const double elevation = elevation_degrees * std::numbers::pi / 180.0;
    return {std::cos(elevation) * std::cos(azimuth),
            std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

// A pulse about 3 samples wide; an ear hears it louder from its own side.
std::vector<double> pulse(double centre, double gain) {
    std::vector<double> samples(256);
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const double t = (static_cast<double>(n) - centre) / 1.5;
        samples[n] = gain * std::exp(-0.5 * t * t);
    }
    return samples;
}

double sphere_delay(double cosine) {
    const double angle = std::acos(std::max(-1.0, std::min(1.0, cosine)));
    return angle <= std::numbers::pi / 2.0 ? -std::cos(angle) : angle - std::numbers::pi / 2.0;
}

HrirSet spherical_head(const std::vector<Vector>& directions, double delay, double radius) {
    HrirSet set{.sample_rate = 48000.0, .directions{}, .centre_delay = 0.0};
    for (const Vector& towards : directions) {
        set.directions.push_back(
            {.towards = towards,
             .left = pulse(delay + radius * sphere_delay(towards[1]), 1.0 + 0.5 * towards[1]),
             .right = pulse(delay + radius * sphere_delay(-towards[1]), 1.0 - 0.5 * towards[1])});
    }
    return set;
}

std::vector<Vector> ring(double begin, double end, double step) {
    std::vector<Vector> directions;
    for (double azimuth = begin; azimuth < end; azimuth += step) {
        directions.push_back(at(azimuth, 0.0));
    }
    return directions;
}

// The onset of a pulse lies a fixed time ahead of its middle: where it has a tenth of its maximum.
TEST(CommonDelay, IsThatOfTheHeadsCentre) {
    const double ahead = 1.5 * std::sqrt(2.0 * std::log(10.0));
    for (const auto& directions : {ring(0.0, 360.0, 10.0),
                                   ring(-60.0, 61.0, 15.0),
                                   ring(30.0, 91.0, 5.0),
                                   std::vector<Vector>{at(0.0, 0.0)}}) {
        const HrirSet set = spherical_head(directions, 70.4, 12.5);
        EXPECT_NEAR(common_delay(set) * 48000.0, 70.4 - ahead, 0.1) << directions.size();
    }
}

TEST(CommonDelay, OfSilenceIsZero) {
    HrirSet set;
    EXPECT_EQ(common_delay(set), 0.0);
    set.directions.push_back({{1.0, 0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}});
    EXPECT_EQ(common_delay(set), 0.0);
}

TEST(FarthestMeasurements, AreThoseNearTheLargestDistance) {
    HrirSet set;
    for (const double distance : {1.0, 2.0, 0.5, 1.95, 1.7}) {
        set.directions.push_back({.distance = distance});
    }
    const HrirSet far = farthest_measurements(set);
    ASSERT_EQ(far.directions.size(), 2U);
    EXPECT_EQ(far.directions[0].distance, 2.0);
    EXPECT_EQ(far.directions[1].distance, 1.95);
}

// Whatever lies below 0.95 of half the lower rate keeps its spectrum, phases counted from the
// head's centre.
TEST(Resampled, KeepsTheSpectrumThatTheLowerRateHolds) {
    HrirSet set{.sample_rate = 44100.0, .directions{}, .centre_delay = 0.3e-3};
    Hrir noise;
    for (std::uint64_t n = 0; n < 300; ++n) {
        noise.left.push_back(random_between(1, 0, n, -1.0, 1.0));
        noise.right.push_back(random_between(1, 1, n, -1.0, 1.0));
    }
    set.directions.push_back(noise);
    for (const double rate : {8000.0, 16000.0, 22050.0, 32000.0}) {
        const HrirSet lower = resampled(set, rate);
        EXPECT_EQ(lower.sample_rate, rate);
        for (const double part : {0.0, 0.01, 0.1, 0.3, 0.6, 0.8, 0.94}) {
            const double hz = 0.5 * rate * part;
            const auto moved = [&](double delay) {
                return std::polar(1.0, 2.0 * std::numbers::pi * hz * delay);
            };
            const auto before = transform(noise.left, hz / 44100.0) * moved(set.centre_delay);
            const auto after =
                transform(lower.directions[0].left, hz / rate) * moved(lower.centre_delay);
            EXPECT_LT(std::abs(after - before), 1e-3 * std::sqrt(300.0 / 3.0))
                << rate << " Hz, at " << hz;
        }
    }
}

TEST(Resampled, HasNoImagesOfWhatLiesAboveTheLowerRate) {
    HrirSet set{.sample_rate = 96000.0, .directions{}, .centre_delay = 0.0};
    Hrir tone;
    for (int n = 0; n < 2000; ++n) {
        const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / 2000.0);
        tone.left.push_back(window * std::cos(2.0 * std::numbers::pi * 30000.0 / 96000.0 * n));
        tone.right.push_back(0.0);
    }
    set.directions.push_back(tone);
    for (const double sample : resampled(set, 48000.0).directions[0].left) {
        EXPECT_LT(std::abs(sample), 2e-4);
    }
}

// A set as a loudspeaker, a microphone and an ear canal colour it: each response through one
// filter, a low cut and a resonance at 3 kHz. The diffuse field is flat without it.
TEST(DiffuseFieldEqualised, TakesOutWhatAllDirectionsHaveInCommon) {
    std::vector<Vector> directions;
    for (double elevation = -90.0; elevation <= 90.0; elevation += 15.0) {
        for (double azimuth = 0.0; azimuth < 360.0; azimuth += 15.0) {
            directions.push_back(at(azimuth, elevation));
        }
    }
    HrirSet set = spherical_head(directions, 60.0, 12.0);
    for (Hrir& direction : set.directions) {
        for (auto* ear : {&direction.left, &direction.right}) {
            double low = 0.0;
            double y1 = 0.0;
            double y2 = 0.0;
            for (double& sample : *ear) {
                low += 0.02 * (sample - low);  // 150 Hz
                const double y = sample - low + 1.75 * y1 - 0.9 * y2;
                y2 = y1;
                y1 = y;
                sample = 0.3 * y;
            }
        }
    }
    const HrirSet flat = diffuse_field_equalised(set);
    ASSERT_EQ(flat.directions.size(), directions.size());
    EXPECT_NEAR(flat.centre_delay, common_delay(set), 1e-12);
    // Up to where the pulses have something to raise. Octaves, the mean over the sphere by the
    // zones of the grid's rings.
    for (const double centre : {63.0, 125.0, 500.0, 1000.0, 2000.0, 4000.0}) {
        double power = 0.0;
        double weight_sum = 0.0;
        for (const Hrir& direction : flat.directions) {
            const double zone = std::sqrt(1.0 - std::pow(direction.towards[2], 2.0));
            for (int k = 0; k < 12; ++k) {
                const double hz = centre * std::pow(2.0, (k + 0.5) / 12.0 - 0.5);
                power += zone * (std::norm(transform(direction.left, hz / 48000.0)) +
                                 std::norm(transform(direction.right, hz / 48000.0)));
                weight_sum += 2.0 * zone;
            }
        }
        EXPECT_NEAR(10.0 * std::log10(power / weight_sum), 0.0, 0.3) << centre;
    }
    // In every direction a head does nothing at low frequencies.
    for (const Hrir& direction : flat.directions) {
        EXPECT_NEAR(
            20.0 * std::log10(std::abs(transform(direction.left, 80.0 / 48000.0))), 0.0, 0.7);
    }
}

TEST(DiffuseFieldEqualised, RefusesSetsWithoutSound) {
    HrirSet set;
    EXPECT_THROW(diffuse_field_equalised(set), Error);
    set.directions.push_back({{1.0, 0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}});
    EXPECT_THROW(diffuse_field_equalised(set), Error);
}

}  // namespace
}  // namespace earshot::audio
