// SPDX-License-Identifier: MIT
#include "earshot/propagation/directivity.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::propagation {
namespace {

const audio::Bands& kBands = audio::Bands::octaves();

double pressure(const Directivity& directivity, const geometry::Vec3& towards) {
    return directivity.pressure(kBands, towards)[5];  // 1 kHz
}

TEST(Directivity, TheCardioidFamilyIsAShareOfEverywhereAndOfTheCosine) {
    const geometry::Vec3 aside(std::cos(1.0), std::sin(1.0), 0.0);
    const auto cardioid = *Directivity::named("cardioid");
    EXPECT_NEAR(pressure(cardioid, aside), 0.5 + 0.5 * std::cos(1.0), 1e-15);
    EXPECT_EQ(pressure(cardioid, {-1, 0, 0}), 0.0);
    EXPECT_EQ(pressure(*Directivity::named("figure-of-eight"), {-1, 0, 0}), -1.0);
    EXPECT_EQ(pressure(*Directivity::named("hypercardioid"), {0, 1, 0}), 0.25);
    EXPECT_TRUE(Directivity::named("omni")->is_omnidirectional());
    EXPECT_FALSE(Directivity::named("heart"));
}

/// Levels at two frequencies, four azimuths and three elevations: 10 dB per quarter turn and -6 dB
/// per 45 degrees up, 4 kHz twice as much.
DirectivityTable table() {
    DirectivityTable table{.frequencies_hz = {1000.0, 4000.0},
                           .azimuths = {0.0, 90.0, 180.0, 270.0},
                           .elevations = {-45.0, 0.0, 45.0},
                           .levels_db = {}};
    for (const double factor : {1.0, 2.0}) {
        for (const double up : {6.0, 0.0, -6.0}) {
            for (const double turn : {0.0, -10.0, -20.0, -10.0}) {
                table.levels_db.push_back(factor * (turn + up));
            }
        }
    }
    return table;
}

double level_db(const Directivity& directivity, double azimuth, double elevation, int band) {
    constexpr double kDegree = 3.141592653589793 / 180.0;
    const double c = std::cos(elevation * kDegree);
    return 20.0 * std::log10(directivity.pressure(
                      kBands,
                      {c * std::cos(azimuth * kDegree),
                       c * std::sin(azimuth * kDegree),
                       std::sin(elevation * kDegree)})[static_cast<std::size_t>(band)]);
}

TEST(Directivity, ATableIsReadBetweenItsDirectionsAndFrequencies) {
    const Directivity directivity = Directivity::tabulated(table());
    EXPECT_NEAR(level_db(directivity, 0, 0, 5), 0.0, 1e-9);
    EXPECT_NEAR(level_db(directivity, 45, 0, 5), -5.0, 1e-9);
    EXPECT_NEAR(level_db(directivity, -45, 0, 5), -5.0, 1e-9);  // past the last azimuth
    EXPECT_NEAR(level_db(directivity, 180, 22.5, 5), -23.0, 1e-9);
    EXPECT_NEAR(level_db(directivity, 0, 80, 5), -6.0, 1e-9);  // held
    // Exact band centres: 1995 and 3981 Hz.
    EXPECT_NEAR(
        level_db(directivity, 90, 0, 6), -10.0 * (1.0 + std::log2(1.995262315) / 2.0), 1e-6);
    EXPECT_NEAR(level_db(directivity, 90, 0, 9), -20.0, 1e-9);  // held
    EXPECT_NEAR(level_db(directivity, 90, 0, 0), -10.0, 1e-9);
    EXPECT_GE(directivity.loudest(), std::pow(10.0, 12.0 / 20.0));
}

TEST(Directivity, RefusesTablesThatAreIncompleteOrOutOfRange) {
    DirectivityTable broken = table();
    broken.levels_db.pop_back();
    EXPECT_THROW(Directivity::tabulated(broken), Error);
    broken = table();
    broken.levels_db[3] = std::nan("");
    EXPECT_THROW(Directivity::tabulated(broken), Error);
    broken = table();
    broken.azimuths = {0.0, 180.0, 90.0, 270.0};
    EXPECT_THROW(Directivity::tabulated(broken), Error);
    broken = table();
    broken.elevations.back() = 91.0;
    EXPECT_THROW(Directivity::tabulated(broken), Error);
}

}  // namespace
}  // namespace earshot::propagation
