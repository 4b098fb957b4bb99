// SPDX-License-Identifier: MIT
#include "earshot/propagation/material.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/test_paths.h"
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>

namespace earshot::propagation {
namespace {

using Points = std::vector<EnergyCoefficient::Point>;

TEST(EnergyCoefficient, HoldsAPlainNumberAtEveryFrequency) {
    const EnergyCoefficient plain(0.37);
    for (const double frequency_hz : {1.0, 31.5, 1000.0, 16000.0}) {
        EXPECT_EQ(plain.at(frequency_hz), 0.37);
    }
}

TEST(EnergyCoefficient, ReturnsGivenPointsExactly) {
    const EnergyCoefficient coefficient(Points{{125.0, 0.1}, {250.0, 0.7}, {500.0, 0.3}});
    EXPECT_EQ(coefficient.at(125.0), 0.1);
    EXPECT_EQ(coefficient.at(250.0), 0.7);
    EXPECT_EQ(coefficient.at(500.0), 0.3);
}

TEST(EnergyCoefficient, IsHeldBeyondTheEnds) {
    const EnergyCoefficient coefficient(Points{{125.0, 0.1}, {500.0, 0.3}});
    EXPECT_EQ(coefficient.at(31.5), 0.1);
    EXPECT_EQ(coefficient.at(124.999), 0.1);
    EXPECT_EQ(coefficient.at(500.001), 0.3);
    EXPECT_EQ(coefficient.at(20000.0), 0.3);
}

// The geometric mean of two frequencies lies half way on a logarithmic axis; a quarter of the way
// is the geometric mean of that and the lower one. A few roundings of logarithms of about 10.
constexpr double kInterpolationTolerance = 1e-14;

TEST(EnergyCoefficient, IsLinearOverTheLogarithmOfFrequency) {
    const EnergyCoefficient coefficient(Points{{100.0, 0.2}, {400.0, 0.6}});
    EXPECT_NEAR(coefficient.at(200.0), 0.4, kInterpolationTolerance);
    EXPECT_NEAR(coefficient.at(std::sqrt(100.0 * 200.0)), 0.3, kInterpolationTolerance);
    EXPECT_NEAR(coefficient.at(std::sqrt(200.0 * 400.0)), 0.5, kInterpolationTolerance);
}

TEST(EnergyCoefficient, StaysBetweenItsPoints) {
    const EnergyCoefficient coefficient(Points{{125.0, 0.3}, {8000.0, 1.0}});
    double last = 0.3;
    for (int step = 0; step < 4000; ++step) {
        const double frequency_hz = 125.0 * std::exp2(6.0 * step / 4000.0);
        const double value = coefficient.at(frequency_hz);
        EXPECT_GE(value, last) << frequency_hz;
        EXPECT_LE(value, 1.0) << frequency_hz;
        last = value;
    }
    EXPECT_LE(coefficient.at(std::nextafter(8000.0, 0.0)), 1.0);
}

TEST(EnergyCoefficient, DoesNotMindTheOrderOfItsPoints) {
    const EnergyCoefficient coefficient(Points{{4000.0, 0.9}, {125.0, 0.1}, {1000.0, 0.5}});
    ASSERT_EQ(coefficient.points().size(), 3U);
    EXPECT_EQ(coefficient.points()[0].frequency_hz, 125.0);
    EXPECT_EQ(coefficient.points()[2].frequency_hz, 4000.0);
    EXPECT_NEAR(coefficient.at(2000.0), 0.7, kInterpolationTolerance);
}

TEST(EnergyCoefficient, GivesOneValuePerBandAtNominalCentres) {
    const EnergyCoefficient coefficient(Points{{125.0, 0.1}, {250.0, 0.2}});
    const audio::Bands& octaves = audio::Bands::octaves();
    const audio::Spectrum spectrum = coefficient.over(octaves);
    for (std::size_t band = 0; band < octaves.count(); ++band) {
        EXPECT_EQ(spectrum[band], octaves.nominal_hz()[band] < 200.0 ? 0.1 : 0.2) << band;
    }
    for (std::size_t band = octaves.count(); band < audio::kMaxBands; ++band) {
        EXPECT_EQ(spectrum[band], 0.0) << band;
    }
}

TEST(EnergyCoefficient, AveragesDataFinerThanTheBand) {
    const EnergyCoefficient thirds(
        Points{{630.0, 0.1}, {800.0, 0.5}, {1000.0, 0.9}, {1250.0, 0.5}, {1600.0, 0.1}});
    const audio::Spectrum octaves = thirds.over(audio::Bands::octaves());
    EXPECT_NEAR(octaves[5], 1.9 / 3.0, 1e-15);  // 1 kHz
    // One point lies within the octaves of 500 Hz and 2 kHz each: interpolated as before.
    EXPECT_EQ(octaves[4], 0.1);
    EXPECT_EQ(octaves[6], 0.1);
    // Thirds take their own values.
    const audio::Bands& bands = audio::Bands::third_octaves();
    const audio::Spectrum own = thirds.over(bands);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        EXPECT_EQ(own[band], thirds.at(bands.nominal_hz()[band])) << band;
    }
}

TEST(Material, MayNotTransmitMoreThanItAbsorbs) {
    Material material;
    material.name = "panel";
    EXPECT_NO_THROW(validate(material));
    material.absorption = EnergyCoefficient(Points{{125.0, 0.5}, {1000.0, 0.1}});
    material.transmission = EnergyCoefficient(Points{{125.0, 0.5}, {1000.0, 0.1}});
    EXPECT_NO_THROW(validate(material));
    // Right at the points of absorption, but not between them.
    material.transmission = EnergyCoefficient(Points{{125.0, 0.2}, {250.0, 0.45}, {1000.0, 0.1}});
    try {
        validate(material);
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), "material \"panel\"");
        EXPECT_NE(std::string(error.what()).find("transmission 0.45 exceeds absorption 0.3"),
                  std::string::npos)
            << error.what();
        EXPECT_NE(std::string(error.what()).find("at 250 Hz"), std::string::npos) << error.what();
    }
}

TEST(TransmittedPressure, CarriesNoMoreEnergyThanIsNotReflected) {
    Material material;
    material.absorption = EnergyCoefficient(Points{{800.0, 0.2}, {1000.0, 0.8}, {1250.0, 0.2}});
    material.transmission = EnergyCoefficient(Points{{1000.0, 0.7}, {1250.0, 0.1}, {800.0, 0.2}});
    EXPECT_NO_THROW(validate(material));
    const audio::Bands& octaves = audio::Bands::octaves();
    const audio::Spectrum transmitted = transmitted_pressure(material, octaves);
    const audio::Spectrum absorption = material.absorption.over(octaves);
    for (std::size_t band = 0; band < octaves.count(); ++band) {
        EXPECT_LE(transmitted[band] * transmitted[band], absorption[band] * (1.0 + 1e-15)) << band;
    }
}

std::string refusal(const Points& points) {
    try {
        const EnergyCoefficient coefficient(points);
    } catch (const Error& error) {
        return error.line();
    }
    return "accepted";
}

TEST(EnergyCoefficient, RefusesWhatIsNoCoefficient) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(refusal({}), "energy coefficient: has no value at any frequency; give at least one");
    EXPECT_EQ(refusal({{500.0, 1.2}}),
              "energy coefficient: is 1.2 at 500 Hz; give a value in 0 ... 1");
    EXPECT_EQ(refusal({{500.0, 0.2}, {250.0, 0.1}, {500.0, 0.3}}),
              "energy coefficient: is given twice at 500 Hz; give it once");
    EXPECT_EQ(refusal({{-1.0, 0.2}}),
              "energy coefficient: is given at a frequency of -1 Hz; give positive frequencies");
    EXPECT_NE(refusal({{0.0, 0.2}}), "accepted");
    EXPECT_NE(refusal({{kNan, 0.2}}), "accepted");
    EXPECT_NE(refusal({{kInfinity, 0.2}}), "accepted");
    EXPECT_NE(refusal({{500.0, -0.001}}), "accepted");
    EXPECT_NE(refusal({{500.0, kNan}}), "accepted");
    EXPECT_EQ(refusal({{500.0, 0.0}, {1000.0, 1.0}}), "accepted");
    EXPECT_THROW(EnergyCoefficient(1.5), Error);
    EXPECT_THROW(EnergyCoefficient{kNan}, Error);
}

TEST(ReflectedPressure, IsTheRootOfTheSpecularEnergy) {
    Material material;
    material.absorption = EnergyCoefficient(Points{{125.0, 0.19}, {250.0, 1.0}, {500.0, 0.36}});
    material.scattering = EnergyCoefficient(Points{{125.0, 0.0}, {500.0, 0.75}});
    const audio::Spectrum pressure = reflected_pressure(material, audio::Bands::octaves());
    // Bands 0 ... 4 of the octaves: 31.5, 63, 125, 250, 500 Hz. Two roundings of numbers below 1.
    constexpr double kTolerance = 4e-16;
    EXPECT_NEAR(pressure[0], 0.9, kTolerance);
    EXPECT_NEAR(pressure[2], 0.9, kTolerance);
    EXPECT_EQ(pressure[3], 0.0);
    EXPECT_NEAR(pressure[4], 0.4, kTolerance);
    EXPECT_NEAR(pressure[9], 0.4, kTolerance);
    EXPECT_EQ(pressure[10], 0.0);
}

TEST(MaterialLibrary, IsLargeSortedAndUnique) {
    const auto library = material_library();
    ASSERT_GE(library.size(), 60U);
    for (std::size_t row = 1; row < library.size(); ++row) {
        EXPECT_LT(library[row - 1].name, library[row].name);
    }
}

TEST(MaterialLibrary, EveryRowIsNamedDescribedAndSourced) {
    for (const LibraryMaterial& row : material_library()) {
        EXPECT_EQ(row.name, row.material.name);
        EXPECT_FALSE(row.name.empty());
        for (const char letter : row.name) {
            const auto code = static_cast<unsigned char>(letter);
            EXPECT_TRUE(std::islower(code) != 0 || std::isdigit(code) != 0 || letter == '-')
                << row.name;
        }
        EXPECT_GE(row.description.size(), 5U) << row.name;
        EXPECT_NE(row.source.find_first_of("0123456789"), std::string_view::npos)
            << row.name << ": a source has a year";
    }
}

TEST(MaterialLibrary, EveryRowCovers125HzTo8kHz) {
    for (const LibraryMaterial& row : material_library()) {
        const auto points = row.material.absorption.points();
        ASSERT_EQ(points.size(), 7U) << row.name;
        EXPECT_EQ(points.front().frequency_hz, 125.0) << row.name;
        EXPECT_EQ(points.back().frequency_hz, 8000.0) << row.name;
        bool absorbs = false;
        for (std::size_t octave = 0; octave < points.size(); ++octave) {
            EXPECT_EQ(points[octave].frequency_hz, 125.0 * std::exp2(octave)) << row.name;
            EXPECT_LE(points[octave].value, 1.0) << row.name;
            absorbs = absorbs || points[octave].value > 0.0;
        }
        EXPECT_TRUE(absorbs) << row.name << ": nothing but zeros";
    }
}

// Spot checks against the printed tables, typed in here again.
TEST(MaterialLibrary, CarriesThePrintedValues) {
    const auto value = [](std::string_view name, double frequency_hz) {
        return find_library_material(name).value().absorption.at(frequency_hz);
    };
    EXPECT_EQ(value("brick-unglazed", 4000.0), 0.07);
    EXPECT_EQ(value("carpet-heavy-on-concrete", 1000.0), 0.37);
    EXPECT_EQ(value("curtain-heavy", 500.0), 0.55);
    EXPECT_EQ(value("glass-window", 125.0), 0.35);
    EXPECT_EQ(value("audience-upholstered-seats", 125.0), 0.62);
    EXPECT_EQ(value("audience-upholstered-seats", 8000.0), 0.85);
    EXPECT_EQ(value("opening", 31.5), 1.0);
}

// The page is what readers check against the books.
TEST(MaterialLibrary, IsTheTableOfItsPage) {
    std::ifstream file(test::source_file("docs/materials.md"));
    const std::string page(std::istreambuf_iterator<char>(file), {});
    const auto values = [](const EnergyCoefficient& coefficient) {
        std::ostringstream text;
        for (const EnergyCoefficient::Point& point : coefficient.points()) {
            text << " " << point.value << " |";
        }
        return text.str();
    };
    for (const LibraryMaterial& row : material_library()) {
        const std::string start = "\n| `" + std::string(row.name) + "` |" +
                                  values(row.material.absorption) + " " + row.source.front() +
                                  " | ";
        const std::size_t found = page.find(start);
        ASSERT_NE(found, std::string::npos) << start;
        const std::size_t key = found + start.size();
        const std::size_t end = page.find(" | ", key);
        EXPECT_EQ(page.substr(end, row.description.size() + 6),
                  " | " + std::string(row.description) + " |\n");
        const std::string scattering = "\n| " + page.substr(key, end - key) + " |" +
                                       values(row.material.scattering) + " " +
                                       std::string(row.scattering_source) + " |\n";
        EXPECT_NE(page.find(scattering), std::string::npos) << row.name << scattering;
    }
}

TEST(MaterialLibrary, ScatteringHasASourceOrIsCalledAnEstimate) {
    for (const LibraryMaterial& row : material_library()) {
        const bool has_year =
            row.scattering_source.find_first_of("0123456789") != std::string_view::npos;
        EXPECT_TRUE(row.scattering_source.starts_with("estimate: ") || has_year) << row.name;
        EXPECT_EQ(row.material.scattering.points().size(), 7U) << row.name;
        for (const EnergyCoefficient::Point& point : row.material.scattering.points()) {
            EXPECT_TRUE(row.name == "opening" ? point.value == 0.0 : point.value >= 0.05)
                << row.name;
        }
    }
}

// s = 0.5 sqrt(depth / wavelength), 0.05 ... 0.99, to two digits.
TEST(MaterialLibrary, ScatteringOfStructuresFollowsTheFormula) {
    std::size_t rows = 0;
    for (const LibraryMaterial& row : material_library()) {
        const std::string source(row.scattering_source);
        if (source.find("sqrt") == std::string::npos) {
            continue;
        }
        ++rows;
        const std::string words = "a structure ";
        const double depth = std::stod(source.substr(source.find(words) + words.size())) / 1000.0;
        for (const EnergyCoefficient::Point& point : row.material.scattering.points()) {
            const double expected = 0.5 * std::sqrt(depth * point.frequency_hz / 343.2);
            EXPECT_NEAR(point.value, std::clamp(expected, 0.05, 0.99), 0.005 + 1e-9)
                << row.name << " at " << point.frequency_hz;
        }
    }
    EXPECT_EQ(rows, 14U);
}

TEST(MaterialLibrary, FindsEveryRowByNameAndNothingElse) {
    for (const LibraryMaterial& row : material_library()) {
        const auto found = find_library_material(row.name);
        ASSERT_TRUE(found.has_value()) << row.name;
        EXPECT_EQ(found->name, row.name);
    }
    EXPECT_FALSE(find_library_material("").has_value());
    EXPECT_FALSE(find_library_material("Brick-Painted").has_value());
    EXPECT_FALSE(find_library_material("zzz").has_value());
}

}  // namespace
}  // namespace earshot::propagation
