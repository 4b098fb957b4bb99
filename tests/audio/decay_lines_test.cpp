// SPDX-License-Identifier: MIT
#include "earshot/audio/decay_lines.h"

#include "earshot/audio/energy_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::audio {
namespace {

constexpr double kBin = 1e-3;

/// Decays of 60 dB in 0.5 s in the first band, 0.1 s more in each further one.
EnergyHistogram exponential_decays() {
    EnergyHistogram late{.bin = kBin, .full_decay = true};
    for (std::size_t n = 0; n < 3000; ++n) {
        Spectrum& energy = late.energy.emplace_back();
        for (std::size_t band = 0; band < Bands::octaves().count(); ++band) {
            const double time = 0.5 + 0.1 * static_cast<double>(band);
            energy[band] = std::pow(10.0, -6.0 * static_cast<double>(n) * kBin / time);
        }
    }
    return late;
}

// Within a bin of the histogram the energy is constant: a tenth of a decibel at most.
constexpr double kToleranceDb = 0.13;

TEST(DecayLines, FollowAnExponentialDecay) {
    const std::vector<BandDecayLines> lines =
        decay_lines(Bands::octaves(), {}, exponential_decays(), {.step = 0.01});
    ASSERT_EQ(lines.size(), Bands::octaves().count());
    for (std::size_t band = 0; band < lines.size(); ++band) {
        const double db_per_second = -60.0 / (0.5 + 0.1 * static_cast<double>(band));
        const auto& level = lines[band].level_db;
        ASSERT_GT(level.size(), 50U);
        EXPECT_EQ(level.front(), 0.0);
        for (std::size_t k = 0; k < level.size(); ++k) {
            EXPECT_NEAR(level[k], db_per_second * 0.01 * static_cast<double>(k), kToleranceDb);
        }
        for (const auto& line : {lines[band].edt, lines[band].t20, lines[band].t30}) {
            ASSERT_TRUE(line);
            EXPECT_NEAR(line->level_from_db, db_per_second * line->from, kToleranceDb);
            EXPECT_NEAR(line->level_to_db, db_per_second * line->to, kToleranceDb);
        }
        EXPECT_NEAR(lines[band].t30->level_from_db, -5.0, kToleranceDb);
        EXPECT_NEAR(lines[band].t30->level_to_db, -35.0, kToleranceDb);
    }
}

TEST(DecayLines, HaveTheTimesOfTheMetrics) {
    EnergyHistogram late = exponential_decays();
    for (std::size_t n = 300; n < late.energy.size(); ++n) {
        for (double& energy : late.energy[n]) {
            energy *= 1.0 + 0.5 * std::sin(0.01 * static_cast<double>(n));
        }
    }
    Arrival direct{.delay = 0.0123};
    direct.pressure.fill(3.0);
    const std::vector arrivals{direct};
    const RoomMetrics metrics = energy_metrics(Bands::octaves(), arrivals, late);
    const auto lines = decay_lines(Bands::octaves(), arrivals, late);
    const auto expect_same = [](const std::optional<DecayLine>& line,
                                const std::optional<double>& metric) {
        ASSERT_TRUE(line && metric);
        // Two ways to the same quotient.
        EXPECT_NEAR(line->reverberation_time(), *metric, 1e-10);
    };
    for (std::size_t band = 0; band < lines.size(); ++band) {
        expect_same(lines[band].edt, metrics.bands[band].early_decay_time);
        expect_same(lines[band].t20, metrics.bands[band].reverberation_time_t20);
        expect_same(lines[band].t30, metrics.bands[band].reverberation_time_t30);
    }
}

TEST(DecayLines, AreEmptyInSilence) {
    for (const BandDecayLines& band : decay_lines(Bands::octaves(), {}, {})) {
        EXPECT_TRUE(band.level_db.empty());
        EXPECT_FALSE(band.edt || band.t20 || band.t30);
    }
    Arrival arrival{.delay = 0.01};
    arrival.pressure[3] = 1.0;
    const auto lines = decay_lines(Bands::octaves(), std::vector{arrival}, {});
    EXPECT_TRUE(lines[2].level_db.empty());
    EXPECT_EQ(lines[3].level_db, std::vector{0.0});
    EXPECT_FALSE(lines[3].t30);
}

}  // namespace
}  // namespace earshot::audio
