// SPDX-License-Identifier: MIT
#include "earshot/audio/spatial.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace earshot::audio {
namespace {

// (l + m)! and the like, small enough to be exact.
double factorial(int n) {
    return std::tgamma(n + 1.0);
}

// By angles and the library's Legendre functions, which share nothing with the recurrences.
double closed_form(int l, int m, double azimuth, double elevation) {
    const int order = std::abs(m);
    const double factor =
        std::sqrt((m == 0 ? 1.0 : 2.0) * factorial(l - order) / factorial(l + order));
    const double legendre = std::assoc_legendre(
        static_cast<unsigned>(l), static_cast<unsigned>(order), std::sin(elevation));
    return factor * legendre * (m < 0 ? std::sin(order * azimuth) : std::cos(order * azimuth));
}

TEST(SphericalHarmonics, AreThoseOfTheClosedForm) {
    std::vector<double> values(ambisonic_channels(5));
    for (std::uint64_t i = 0; i < 200; ++i) {
        const double azimuth = random_between(1, 0, i, -3.14, 3.14);
        const double elevation = i < 2 ? (i == 0 ? 1.0 : -1.0) * 1.5707963267948966
                                       : random_between(1, 1, i, -1.57, 1.57);
        spherical_harmonics(5,
                            {std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth),
                             std::sin(elevation)},
                            values);
        for (int l = 0; l <= 5; ++l) {
            for (int m = -l; m <= l; ++m) {
                EXPECT_NEAR(values[static_cast<std::size_t>(l * l + l + m)],
                            closed_form(l, m, azimuth, elevation),
                            1e-12)
                    << "l " << l << ", m " << m << ", direction " << i;
            }
        }
    }
}

// The sum of the squares of a degree is 1 in every direction (addition theorem, SN3D).
TEST(SphericalHarmonics, OfADegreeHaveUnitEnergy) {
    std::vector<double> values(ambisonic_channels(5));
    spherical_harmonics(5, {2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0}, values);
    for (std::size_t l = 0; l <= 5; ++l) {
        double sum = 0.0;
        for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) {
            sum += values[k] * values[k];
        }
        EXPECT_NEAR(sum, 1.0, 1e-13) << l;
    }
}

Arrival from(std::array<double, 3> towards, double delay) {
    Arrival arrival;
    arrival.delay = delay;
    arrival.pressure.fill(0.5);
    arrival.direction = {-towards[0], -towards[1], -towards[2]};
    return arrival;
}

// Delays of whole samples: an arrival is one sample, so channels can be read off.
TEST(EncodeAmbisonic, HearsAPlaneWaveWhereTheListenerSeesIt) {
    const Assembler assembler(Bands::octaves());
    const Orientation facing_y{{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    const std::vector<Arrival> arrivals = {
        from({0.0, 1.0, 0.0}, 0.01), from({1.0, 0.0, 0.0}, 0.02), from({0.0, 0.0, 2.0}, 0.03)};
    const auto channels = encode_ambisonic(assembler, arrivals, 1, facing_y);
    ASSERT_EQ(channels.size(), 4U);
    const double expected[3][4] = {{0.5, 0.0, 0.0, 0.5},   // in front: W, X
                                   {0.5, -0.5, 0.0, 0.0},  // to the right: W, -Y
                                   {0.5, 0.0, 0.5, 0.0}};  // above: W, Z
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_NEAR(channels[c].samples[480 * (i + 1)], expected[i][c], 1e-6) << i << " " << c;
        }
    }
}

TEST(EncodeAmbisonic, HasTheMonoResponseInItsFirstChannel) {
    const Assembler assembler(Bands::octaves());
    std::vector<Arrival> arrivals(100);
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        arrivals[i].delay = random(3, 0, i) * 0.1;
        for (std::size_t k = 0; k < 3; ++k) {
            arrivals[i].direction[k] = random_between(3, 1 + k, i, -1.0, 1.0);
        }
        for (std::size_t b = 0; b < kMaxBands; ++b) {
            arrivals[i].pressure[b] = random_between(3, b + 4, i, 0.01, 1.0);
        }
    }
    const auto mono = assembler.assemble(arrivals);
    for (const int order : {0, 2}) {
        const auto channels = encode_ambisonic(assembler, arrivals, order);
        ASSERT_EQ(channels.size(), ambisonic_channels(order));
        EXPECT_EQ(channels[0].samples, mono.samples);
    }
}

TEST(EncodeAmbisonic, RefusesWhatItCannotEncode) {
    const Assembler assembler(Bands::octaves());
    std::vector<Arrival> arrivals = {from({1.0, 0.0, 0.0}, 0.01)};
    EXPECT_THROW(encode_ambisonic(assembler, arrivals, 6), Error);
    EXPECT_THROW(encode_ambisonic(assembler, arrivals, -1), Error);
    arrivals[0].direction[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(encode_ambisonic(assembler, arrivals, 1), Error);
}

}  // namespace
}  // namespace earshot::audio
