// SPDX-License-Identifier: MIT
#include "earshot/propagation/air.h"

#include "earshot/base/error.h"
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

#include "support/test_paths.h"
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

TEST(Air, ManyDistancesHaveTheBitsOfOne) {
    const Air air = {.temperature_c = 13.0, .humidity_percent = 31.0};
    const std::vector<double> distances = {0.0, 0.01, 1.0 / 3.0, 7.5, 123.456, 3000.0, 1e6};
    for (const audio::Bands& bands : {audio::Bands::octaves(), audio::Bands::third_octaves()}) {
        const AirAbsorption absorption(air, bands);
        for (const std::string& target : simd_targets()) {
            override_simd_target(target);
            const std::vector<double> factors = absorption.pressures(distances);
            for (std::size_t i = 0; i < distances.size(); ++i) {
                const audio::Spectrum expected = air_pressure(air, bands, distances[i]);
                for (std::size_t band = 0; band < bands.count(); ++band) {
                    EXPECT_EQ(factors[i * absorption.stride() + band], expected[band])
                        << target << ", " << distances[i] << " m, band " << band;
                }
            }
        }
        override_simd_target("auto");
    }
}

TEST(Air, CarriesSoundAt343Point2MetresPerSecondByDefault) {
    EXPECT_DOUBLE_EQ(speed_of_sound({}), 343.2);
    EXPECT_NEAR(speed_of_sound({.temperature_c = 0.0}), 331.29, 0.01);
}

// Its rows were made by another program from the same formulas and printed with six digits: half a
// unit in the sixth digit is 5e-6 of a value that begins with 1.
TEST(Air, AbsorbsAsTheTableOfIso9613Says) {
    std::ifstream file(test::source_file("tests/data/iso9613-1-alpha.csv"));
    ASSERT_TRUE(file) << "tests/data/iso9613-1-alpha.csv is missing";
    std::string line;
    std::getline(file, line);
    int rows = 0;
    while (std::getline(file, line)) {
        std::istringstream cells(line);
        Air air;
        double nominal_hz = 0.0, exact_hz = 0.0, expected = 0.0;
        char comma = ',';
        cells >> air.temperature_c >> comma >> air.humidity_percent >> comma >> nominal_hz >>
            comma >> exact_hz >> comma >> expected;
        ASSERT_TRUE(cells) << line;
        // The column holds three decimals of the exact mid-band frequency.
        const double steps = std::round(10.0 * std::log10(nominal_hz / 1000.0) / 3.0);
        const double frequency_hz = 1000.0 * std::pow(10.0, 0.3 * steps);
        ASSERT_NEAR(frequency_hz, exact_hz, 1e-3);
        EXPECT_NEAR(1000.0 * absorption_db_per_metre(air, frequency_hz) / expected, 1.0, 1e-5)
            << line;
        ++rows;
    }
    EXPECT_EQ(rows, 240);
}

TEST(Air, LosesTheSameDecibelsOverEveryMetre) {
    const audio::Bands& bands = audio::Bands::octaves();
    const auto factor = air_pressure({}, bands, 100.0);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const double lost_db = 100.0 * absorption_db_per_metre({}, bands.exact_hz()[band]);
        EXPECT_NEAR(-20.0 * std::log10(factor[band]), lost_db, 1e-10);
    }
    EXPECT_EQ(factor[bands.count()], 0.0);
    EXPECT_EQ(air_pressure({}, bands, 0.0)[9], 1.0);
}

TEST(Air, RefusesWhatIsOutsideTheRanges) {
    EXPECT_NO_THROW(validate({}));
    EXPECT_NO_THROW(validate({.temperature_c = -50.0, .humidity_percent = 0.0}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {-300.0, 71.0, nan}) {
        EXPECT_THROW(validate({.temperature_c = bad}), Error) << bad;
    }
    for (const double bad : {-1.0, 101.0, nan}) {
        EXPECT_THROW(validate({.humidity_percent = bad}), Error) << bad;
    }
    for (const double bad : {0.0, 101325.0, nan}) {
        EXPECT_THROW(validate({.pressure_kpa = bad}), Error) << bad;
    }
}

TEST(Air, AbsorbsLittleButFinitelyWhenDry) {
    const double dry = absorption_db_per_metre({.humidity_percent = 0.0}, 1000.0);
    EXPECT_GT(dry, 0.0);
    EXPECT_LT(dry, 0.01);
    EXPECT_EQ(absorption_db_per_metre({}, 0.0), 0.0);
}

}  // namespace
}  // namespace earshot::propagation
