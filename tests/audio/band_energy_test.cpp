// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/band_energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace earshot::audio {
namespace {

const FilterCache kCache;

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

// Class 1 limits for octave-band filters: frequency over the centre, minimum and maximum
// attenuation in decibels (IEC 61260:1995, table 1; the lower half mirrors the upper).
struct Limit {
    double octaves;
    double min_db;
    double max_db;
};
constexpr Limit kClass1[] = {{0.0, -0.3, 0.3},
                             {1.0 / 8, -0.3, 0.4},
                             {1.0 / 4, -0.3, 0.6},
                             {3.0 / 8, -0.3, 1.3},
                             {0.5 - 1e-9, -0.3, 5.0},
                             {0.5 + 1e-9, 2.0, 5.0},
                             {1.0, 17.5, 1e9},
                             {2.0, 42.0, 1e9},
                             {3.0, 61.0, 1e9},
                             {4.0, 70.0, 1e9}};

TEST(BandPowerGain, KeepsTheClass1LimitsInOctaves) {
    const Bands& bands = Bands::octaves();
    for (const Limit& limit : kClass1) {
        for (const double side : {-1.0, 1.0}) {
            const double ratio = std::pow(10.0, 0.3 * side * limit.octaves);
            const double loss_db =
                -10 * std::log10(band_power_gain(bands, 5, bands.exact_hz()[5] * ratio));
            EXPECT_GE(loss_db, limit.min_db) << side * limit.octaves;
            EXPECT_LE(loss_db, limit.max_db) << side * limit.octaves;
        }
    }
}

TEST(BandPowerGain, IsOneHalfAtTheEdges) {
    for (const Bands* bands : {&Bands::octaves(), &Bands::third_octaves()}) {
        for (std::size_t b = 0; b < bands->count(); ++b) {
            EXPECT_NEAR(band_power_gain(*bands, b, bands->upper_edge_hz(b)), 0.5, 1e-12);
            EXPECT_NEAR(band_power_gain(*bands, b, bands->lower_edge_hz(b)), 0.5, 1e-12);
        }
    }
    EXPECT_EQ(band_power_gain(Bands::octaves(), 0, 0.0), 0.0);
}

TEST(BandEnergy, OfAnImpulseIsSymmetricInTime) {
    std::vector<double> impulse(2001, 0.0);
    impulse[1000] = 1.0;
    const BandEnergy energy(Bands::octaves(), impulse, 48000.0, kCache);
    for (std::size_t band = 2; band < 10; ++band) {
        const auto squared = energy.squared(band);
        const std::size_t centre = energy.lead() + 1000;
        for (std::size_t n = 1; n < 1000; ++n) {
            ASSERT_NEAR(squared[centre - n], squared[centre + n], 1e-14) << band << " " << n;
        }
        EXPECT_NEAR(sum(squared) / energy.of_unit_impulse(band), 1.0, 1e-9) << band;
    }
}

TEST(BandEnergy, HoldsTheRingingOfTheLowestBand) {
    for (const Bands* bands : {&Bands::octaves(), &Bands::third_octaves()}) {
        const BandEnergy energy(*bands, std::vector<double>{1.0}, 8000.0, kCache);
        const auto squared = energy.squared(0);
        EXPECT_EQ(squared.size(), 1 + 2 * energy.lead());
        EXPECT_NEAR(sum(squared) / energy.of_unit_impulse(0), 1.0, 1e-6);
        EXPECT_LT(squared.back(), 1e-6 * squared[energy.lead()]);
    }
}

TEST(BandEnergy, OfAToneLiesInItsBand) {
    std::vector<double> tone(48000);
    for (std::size_t n = 0; n < tone.size(); ++n) {
        // Fades in and out, or its ends would be heard in every band.
        const double along = static_cast<double>(n) / 48000.0;
        tone[n] = std::pow(std::sin(3.14159265 * along), 4) * std::sin(6283.185307 * along);
    }
    const double all = std::inner_product(tone.begin(), tone.end(), tone.begin(), 0.0);
    const BandEnergy energy(Bands::octaves(), tone, 48000.0, kCache);
    EXPECT_NEAR(sum(energy.squared(5)) / all, 1.0, 1e-3);
    EXPECT_NEAR(10 * std::log10(sum(energy.squared(6)) / all), -19.7, 0.1);
    EXPECT_LT(10 * std::log10(sum(energy.squared(7)) / all), -43.0);
    EXPECT_LT(10 * std::log10(sum(energy.squared(3)) / all), -43.0);
}

TEST(BandEnergy, CoversBandsBelowHalfTheSampleRate) {
    const std::vector<double> any{1.0};
    EXPECT_TRUE(BandEnergy(Bands::octaves(), any, 48000.0, kCache).covers(9));
    EXPECT_FALSE(BandEnergy(Bands::octaves(), any, 44100.0, kCache).covers(9));
    EXPECT_TRUE(BandEnergy(Bands::octaves(), any, 44100.0, kCache).covers(8));
}

}  // namespace
}  // namespace earshot::audio
