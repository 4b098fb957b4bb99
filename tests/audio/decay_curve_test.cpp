// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/decay_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::audio {
namespace {

constexpr double kSampleRate = 48000.0;
constexpr double kWide = 1e5;  // hertz: a filter that limits nothing
constexpr DecayRange kAll[] = {kEarlyDecay, kT20, kT30};

// Energy that falls by 60 dB in `time`, cut off at a depth.
std::vector<double> exponential(double time, double cut_off_db) {
    std::vector<double> squared;
    for (std::size_t n = 0;; ++n) {
        const double level_db = -60.0 * static_cast<double>(n) / kSampleRate / time;
        if (level_db < -cut_off_db) {
            return squared;
        }
        squared.push_back(std::pow(10.0, level_db / 10.0));
    }
}

TEST(DecayCurve, ReadsTheTimeOfAnExponential) {
    for (const double time : {0.1, 0.5, 2.0}) {
        const DecayCurve curve(exponential(time, 120.0), 0, kSampleRate);
        for (const DecayRange& range : kAll) {
            const auto reading = curve.read(range, kWide);
            ASSERT_TRUE(reading.time) << range.name << reading.why_not;
            // The cut at 120 dB takes 1e-12 of the energy; levels stand at whole samples.
            EXPECT_NEAR(*reading.time / time, 1.0, 1e-6) << range.name;
        }
    }
}

TEST(DecayCurve, CountsEnergyBeforeTheOnset) {
    const std::vector<double> squared{1.0, 2.0, 4.0, 8.0, 1.0};
    const DecayCurve curve(squared, 2, 10.0);
    EXPECT_EQ(curve.energy(), 16.0);
    EXPECT_EQ(curve.energy_from(0.0), 13.0);
    EXPECT_EQ(curve.energy_from(0.1), 9.0);
    EXPECT_EQ(curve.energy_from(0.2), 1.0);
    EXPECT_EQ(curve.energy_from(0.3), 0.0);
}

// What truncation costs is known: the curve lies 10 log10(1 - C / S) too low, so at the lower end
// of a range that it supports by 10 dB or more the time is short by no more than a few per cent.
TEST(DecayCurve, EndsWhereTheResponseWasCutOff) {
    for (int cut_off = 10; cut_off <= 80; cut_off += 5) {
        const DecayCurve curve(exponential(1.0, cut_off), 0, kSampleRate);
        for (const DecayRange& range : kAll) {
            const auto reading = curve.read(range, kWide);
            if (reading.time) {
                EXPECT_GE(cut_off, range.to_db + 10) << range.name;
                EXPECT_NEAR(*reading.time, 1.0, 0.05) << range.name << " cut at " << cut_off;
            } else {
                EXPECT_LT(cut_off, 60) << range.name;
                EXPECT_TRUE(reading.ends_early);
                EXPECT_TRUE(reading.why_not.starts_with("decay range ") ||
                            reading.why_not.starts_with("the decay bends "))
                    << reading.why_not;
            }
        }
    }
}

TEST(DecayCurve, NamesTheRangeThatThereIs) {
    const DecayCurve curve(exponential(1.0, 42.0), 0, kSampleRate);
    const std::string why = curve.read(kT30, kWide).why_not;
    EXPECT_NE(why.find(" dB, 35 dB needed"), std::string::npos) << why;
}

TEST(DecayCurve, AcceptsASecondSlowerSlope) {
    auto squared = exponential(0.5, 120.0);
    const auto slow = exponential(3.0, 120.0);
    squared.resize(slow.size(), 0.0);
    for (std::size_t n = 0; n < slow.size(); ++n) {
        squared[n] += 1e-3 * slow[n];
    }
    const DecayCurve curve(squared, 0, kSampleRate);
    const auto early = curve.read(kEarlyDecay, kWide).time;
    const auto late = curve.read(kT30, kWide).time;
    ASSERT_TRUE(early && late);
    EXPECT_LT(*early, 0.6);
    EXPECT_GT(*late, 1.0);
}

TEST(DecayCurve, LeavesTheDecayOfTheFilterOut) {
    const DecayCurve curve(exponential(0.1, 120.0), 0, kSampleRate);
    const auto reading = curve.read(kT20, 50.0);
    EXPECT_FALSE(reading.time);
    EXPECT_FALSE(reading.ends_early);
    EXPECT_EQ(reading.why_not, "decay of 100 ms, the band's filter needs 320 ms");
    EXPECT_TRUE(curve.read(kT20, 161.0).time);
}

TEST(DecayCurve, OfOneSampleHasNoDecay) {
    const DecayCurve curve(std::vector<double>{1.0}, 0, kSampleRate);
    for (const DecayRange& range : kAll) {
        EXPECT_FALSE(curve.read(range, kWide).time);
    }
}

}  // namespace
}  // namespace earshot::audio
