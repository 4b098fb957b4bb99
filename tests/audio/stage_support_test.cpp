// SPDX-License-Identifier: MIT
#include "earshot/audio/stage_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace earshot::audio {
namespace {

constexpr double kRate = 48000.0;
constexpr std::size_t kOnset = 2000;

ImpulseResponse impulses(const std::vector<std::pair<double, double>>& hits) {
    ImpulseResponse response{kRate, std::vector<double>(72000)};
    for (const auto& [time, amplitude] : hits) {
        response.samples[kOnset + std::size_t(std::lround(time * kRate))] += amplitude;
    }
    return response;
}

// An impulse through a band's filter has the energy of its square, wherever it is.
TEST(StageSupport, IsTheEnergyOfReflectionsOverThatOfTheDirectSound) {
    const Bands& bands = Bands::octaves();
    const auto support = stage_support(
        bands, impulses({{0.0, 1.0}, {0.05, 0.5}, {0.3, 0.2}, {1.2, 0.7}}), kOnset, false);
    for (std::size_t band = 4; band < bands.count(); ++band) {
        ASSERT_TRUE(support.early_db[band] && support.late_db[band]);
        EXPECT_NEAR(*support.early_db[band], 20.0 * std::log10(0.5), 0.1) << band;
        EXPECT_NEAR(*support.late_db[band], 20.0 * std::log10(0.2), 0.1) << band;
    }
    ASSERT_TRUE(support.early_mean_db && support.late_mean_db);
    EXPECT_NEAR(*support.early_mean_db, 20.0 * std::log10(0.5), 0.3);
    EXPECT_NEAR(*support.late_mean_db, 20.0 * std::log10(0.2), 0.3);
}

TEST(StageSupport, OfAShortResponseIsEmptyWithANote) {
    ImpulseResponse response = impulses({{0.0, 1.0}});
    response.samples.resize(kOnset + 4000);
    const auto support = stage_support(Bands::octaves(), response, kOnset, false);
    EXPECT_FALSE(support.early_db[5] || support.late_db[5] || support.early_mean_db);
    ASSERT_EQ(support.notes.size(), 2U);
    EXPECT_EQ(support.notes[0].metric, "st_early");
}

TEST(LateLateralLevel, IsReFreeFieldAtTenMetres) {
    const Bands& bands = Bands::octaves();
    const ImpulseResponse eight = impulses({{0.02, 0.5}, {0.2, 0.03}, {0.4, 0.04}});
    const std::vector<std::optional<double>> none(bands.count(), 0.0);
    const auto level = late_lateral_level(bands, eight, kOnset, false, none);
    // 0.05 of both late ones together, over 0.1.
    for (std::size_t band = 4; band < bands.count(); ++band) {
        ASSERT_TRUE(level.level_db[band]);
        EXPECT_NEAR(*level.level_db[band], 20.0 * std::log10(0.5), 0.1) << band;
    }
    const std::vector<std::optional<double>> three(bands.count(), 3.0);
    const auto raised = late_lateral_level(bands, eight, kOnset, false, three);
    EXPECT_NEAR(*raised.level_db[6] - *level.level_db[6], 3.0, 1e-9);
    EXPECT_NEAR(*raised.mean_db - *level.mean_db, 3.0, 1e-9);

    const auto uncalibrated = late_lateral_level(bands, eight, kOnset, false, {});
    EXPECT_FALSE(uncalibrated.level_db[6] || uncalibrated.mean_db);
    ASSERT_EQ(uncalibrated.notes.size(), 1U);
    EXPECT_EQ(uncalibrated.notes[0].metric, "lj");
}

}  // namespace
}  // namespace earshot::audio
