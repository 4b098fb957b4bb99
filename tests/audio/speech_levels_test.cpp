// SPDX-License-Identifier: MIT
#include "earshot/audio/speech_levels.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/response_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::audio {
namespace {

TEST(StiLetter, ChangesAtTheLimitsOfTheStandard) {
    // IEC 60268-16:2011, annex F: bands of 0.04 about 0.38 (J) ... 0.74 (A).
    const std::string letters = "JIHGFEDCBA";
    for (std::size_t i = 0; i < letters.size(); ++i) {
        const double middle = 0.38 + 0.04 * static_cast<double>(i);
        for (const double offset : {-0.0199, 0.0, 0.0199}) {
            EXPECT_EQ(sti_letter(middle + offset), letters.substr(i, 1)) << middle + offset;
        }
    }
    EXPECT_EQ(sti_letter(0.3599), "U");
    EXPECT_EQ(sti_letter(0.36), "J");
    EXPECT_EQ(sti_letter(0.76), "A");
    EXPECT_EQ(sti_letter(0.7601), "A+");
    EXPECT_EQ(sti_letter(0.0), "U");
    EXPECT_EQ(sti_letter(1.0), "A+");
}

TEST(NoiseCriterion, CurvesAreThoseOfBeranek) {
    EXPECT_EQ(noise_criterion_db(15.0), (SpeechSpectrum{36, 29, 22, 17, 14, 12, 11}));
    EXPECT_EQ(noise_criterion_db(30.0), (SpeechSpectrum{48, 41, 35, 31, 29, 28, 27}));
    EXPECT_EQ(noise_criterion_db(65.0), (SpeechSpectrum{75, 71, 68, 66, 64, 63, 62}));
    EXPECT_EQ(noise_criterion_db(70.0), (SpeechSpectrum{79, 75, 72, 71, 70, 69, 68}));
    const auto between = noise_criterion_db(32.0);
    ASSERT_TRUE(between);
    EXPECT_NEAR((*between)[0], 48.0 + 0.4 * 4.0, 1e-12);
    EXPECT_NEAR((*between)[6], 27.0 + 0.4 * 5.0, 1e-12);
    EXPECT_FALSE(noise_criterion_db(14.9));
    EXPECT_FALSE(noise_criterion_db(70.1));
    EXPECT_FALSE(noise_criterion_db(std::nan("")));
    // A curve is louder than the one below in every octave, and named for its level at 2 kHz or so.
    for (double number = 15.0; number < 70.0; number += 5.0) {
        const auto lower = noise_criterion_db(number).value();
        const auto upper = noise_criterion_db(number + 5.0).value();
        for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
            EXPECT_LT(lower[octave], upper[octave]);
        }
        EXPECT_NEAR(lower[4], number, 1.5);
    }
}

TEST(MaleSpeech, HasItsAWeightedLevel) {
    // A-weighting of the octaves from 125 Hz on (IEC 61672-1, table 3).
    constexpr SpeechSpectrum kWeighting = {-16.1, -8.6, -3.2, 0.0, 1.2, 1.0, -1.1};
    const SpeechSpectrum levels = male_speech_db(66.0);
    double sum = 0.0;
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        sum += std::pow(10.0, (levels[octave] + kWeighting[octave]) / 10.0);
    }
    EXPECT_NEAR(10.0 * std::log10(sum), 66.0, 0.1);
}

// Computed apart from this program, from the formulas of annex A.
struct Case {
    double level_db, direct, beside, decay;
};
constexpr Case kCases[] = {{60.0, 0.4317393924262328, 0.9587660085841208, 0.5663511227244977},
                           {66.0, 0.6295440022078713, 0.9959647611888154, 0.5795888687466986},
                           {72.0, 0.8220574035174948, 1.0, 0.5810644694299871}};

SpeechConditions in_noise(double level_db, bool at_listener = false) {
    return {.speech_level_db = level_db,
            .at_listener = at_listener,
            .noise_db = noise_criterion_db(30.0)};
}

TEST(SpeechConditions, AreMetAtTheListenerByTheEnergyThatArrives) {
    // Direct sound at 10 m is 20 dB below that at 1 m.
    std::vector<Arrival> direct = {{.delay = 0.03}};
    direct[0].pressure.fill(0.1);
    const auto index = [&](const SpeechConditions& conditions) {
        return energy_metrics(Bands::octaves(), direct, {}, {.speech = conditions})
            .speech_transmission_index.value();
    };
    for (const Case& expected : kCases) {
        EXPECT_NEAR(index(in_noise(expected.level_db)), expected.direct, 1e-4);
        EXPECT_NEAR(index(in_noise(expected.level_db, true)), expected.beside, 1e-4);
    }
    // Without noise the threshold of hearing is left: speech of 40 dB(A).
    EXPECT_NEAR(index({.speech_level_db = 60.0}), 0.9233727599003915, 1e-4);
}

TEST(SpeechConditions, LimitADecayToo) {
    // 60 dB in a second from all around, as loud as the talker's free field at 1 m.
    EnergyHistogram late = {.full_decay = true};
    for (int n = 0; n < 1500; ++n) {
        late.energy.emplace_back().fill(std::exp(-13.815510557964274 * n * 1e-3) *
                                        (1.0 - std::exp(-0.013815510557964274)));
    }
    for (const Case& expected : kCases) {
        const RoomMetrics metrics =
            energy_metrics(Bands::octaves(), {}, late, {.speech = in_noise(expected.level_db)});
        EXPECT_NEAR(metrics.speech_transmission_index.value(), expected.decay, 1e-3);
    }
}

TEST(SpeechConditions, AreMetByAResponseAsByItsEnergies) {
    ImpulseResponse response{.sample_rate = 48000.0, .samples = std::vector<double>(24000, 0.0)};
    response.samples[1440] = 0.1;
    for (const Case& expected : kCases) {
        const RoomMetrics metrics =
            response_metrics(Bands::octaves(),
                             response,
                             {.full_decay = true, .speech = in_noise(expected.level_db)});
        // The filters ring.
        EXPECT_NEAR(metrics.speech_transmission_index.value(), expected.direct, 3e-3);
    }
}

TEST(SpeechConditions, OfThirdsAreMetByTheirMean) {
    std::vector<Arrival> direct = {{.delay = 0.03}};
    direct[0].pressure.fill(0.1);
    for (const Case& expected : kCases) {
        const RoomMetrics metrics = energy_metrics(
            Bands::third_octaves(), direct, {}, {.speech = in_noise(expected.level_db)});
        EXPECT_NEAR(metrics.speech_transmission_index.value(), expected.direct, 1e-4);
    }
}

}  // namespace
}  // namespace earshot::audio
