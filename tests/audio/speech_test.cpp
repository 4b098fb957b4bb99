// SPDX-License-Identifier: MIT
#include "earshot/audio/speech.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::audio {
namespace {

/// An exponential decay of energy, 60 dB in `time` seconds, in every octave.
std::vector<std::vector<double>> ideal_decays(double time, double sample_rate) {
    std::vector<double> squared;
    for (double t = 0.0; t < 3.0 * time; t += 1.0 / sample_rate) {
        squared.push_back(std::exp(-13.815510557964274 * t / time));
    }
    return std::vector<std::vector<double>>(kSpeechBands, squared);
}

TEST(SpeechTransmission, OfIdealDecaysIsThatOfTheClosedForm) {
    struct Case {
        double time, index;
    };
    // From m(F) = 1 / sqrt(1 + (2 pi F T / 13.8)^2).
    for (const Case& expected : {Case{0.3, 0.827524731070227},
                                 Case{0.5, 0.736301557485973},
                                 Case{1.0, 0.5884787288696275},
                                 Case{2.0, 0.4373575143558845},
                                 Case{4.0, 0.3035128727350793}}) {
        const auto decays = ideal_decays(expected.time, 8000.0);
        const SpeechTransmission speech = speech_transmission(decays, 8000.0);
        EXPECT_NEAR(speech.index, expected.index, 5e-4) << expected.time;
        for (const double modulation : speech.modulation) {
            EXPECT_NEAR(modulation, expected.index, 5e-4);
        }
    }
}

TEST(SpeechTransmission, OfAnImpulseIsPerfect) {
    ImpulseResponse response{.sample_rate = 48000.0, .samples = std::vector<double>(4800, 0.0)};
    response.samples[100] = 0.5;
    const auto speech = speech_transmission(response);
    ASSERT_TRUE(speech);
    EXPECT_GT(speech->index, 0.995);
}

TEST(SpeechTransmission, OfDecayingNoiseIsCloseToTheIdeal) {
    constexpr double kTime = 1.0;
    ImpulseResponse response{.sample_rate = 48000.0, .samples = {}};
    for (std::uint64_t n = 0; n < 72000; ++n) {
        const double t = static_cast<double>(n) / response.sample_rate;
        response.samples.push_back((random(1, 0, n) - 0.5) * std::exp(-6.907755 * t / kTime));
    }
    const auto speech = speech_transmission(response);
    ASSERT_TRUE(speech);
    EXPECT_NEAR(speech->index, 0.5885, 0.02);
}

TEST(SpeechTransmission, NoiseMaskingAndThresholdReduceItByTheStandardsFormula) {
    const std::vector<std::vector<double>> impulse(kSpeechBands, {1.0});
    const auto index_at = [&](const SpeechSpectrum& speech, const SpeechSpectrum& noise) {
        return speech_transmission(impulse, 8000.0, SpeechLevels{speech, noise}).index;
    };
    const auto flat = [](double level) {
        SpeechSpectrum spectrum;
        spectrum.fill(level);
        return spectrum;
    };
    // Computed apart from this program.
    EXPECT_NEAR(index_at(flat(60.0), flat(60.0)), 0.4996317015309901, 1e-9);
    EXPECT_NEAR(
        index_at({62.9, 62.9, 59.2, 53.2, 47.2, 41.2, 35.2}, flat(45.0)), 0.6333893204529718, 1e-9);
    EXPECT_NEAR(index_at(flat(80.0), flat(40.0)), 1.0, 1e-9);
    EXPECT_EQ(index_at(flat(20.0), flat(90.0)), 0.0);
}

TEST(SpeechTransmission, NeedsEveryOctave) {
    ImpulseResponse response{.sample_rate = 16000.0, .samples = std::vector<double>(1600, 0.0)};
    EXPECT_FALSE(speech_transmission(response));  // 8 kHz reaches past half the sample rate
    response.sample_rate = 48000.0;
    EXPECT_FALSE(speech_transmission(response));  // silent
    response.samples.clear();
    EXPECT_FALSE(speech_transmission(response));
}

}  // namespace
}  // namespace earshot::audio
