// SPDX-License-Identifier: MIT
#include "earshot/audio/bands.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::audio {
namespace {

// Nominal frequencies are the exact ones rounded to the preferred numbers of ISO 3 (R10): never
// more than 1.3 % away.
constexpr double kRoundingOfPreferredNumbers = 0.013;

TEST(Bands, OctavesRunFrom31Point5HertzTo16Kilohertz) {
    const Bands& bands = Bands::octaves();
    ASSERT_EQ(bands.count(), 10U);
    EXPECT_EQ(bands.nominal_hz().front(), 31.5);
    EXPECT_EQ(bands.nominal_hz().back(), 16000.0);
}

TEST(Bands, ThirdOctavesRunFrom20HertzTo20Kilohertz) {
    const Bands& bands = Bands::third_octaves();
    ASSERT_EQ(bands.count(), 31U);
    EXPECT_EQ(bands.nominal_hz().front(), 20.0);
    EXPECT_EQ(bands.nominal_hz().back(), 20000.0);
}

TEST(Bands, ExactCentresAreTheBaseTenOnesAroundOneKilohertz) {
    const auto octaves = Bands::octaves().exact_hz();
    EXPECT_EQ(octaves[5], 1000.0);
    EXPECT_NEAR(octaves[8], 7943.282347242815, 1e-9);
    const auto thirds = Bands::third_octaves().exact_hz();
    EXPECT_EQ(thirds[17], 1000.0);
    EXPECT_NEAR(thirds[0], 19.952623149688797, 1e-12);
}

TEST(Bands, NominalCentresAreWithinRoundingOfTheExactOnes) {
    for (const Bands* bands : {&Bands::octaves(), &Bands::third_octaves()}) {
        for (std::size_t b = 0; b < bands->count(); ++b) {
            EXPECT_NEAR(
                bands->nominal_hz()[b] / bands->exact_hz()[b], 1.0, kRoundingOfPreferredNumbers)
                << "band " << b;
        }
    }
}

TEST(Bands, EdgesOfNeighboursMeet) {
    for (const Bands* bands : {&Bands::octaves(), &Bands::third_octaves()}) {
        for (std::size_t b = 0; b + 1 < bands->count(); ++b) {
            EXPECT_NEAR(bands->upper_edge_hz(b) / bands->lower_edge_hz(b + 1), 1.0, 1e-12);
        }
    }
    EXPECT_NEAR(Bands::octaves().upper_edge_hz(5), 1412.537544622754, 1e-9);
}

}  // namespace
}  // namespace earshot::audio
