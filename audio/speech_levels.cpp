// SPDX-License-Identifier: MIT
#include "earshot/audio/speech_levels.h"

#include "earshot/base/math.h"

#include <algorithm>

namespace earshot::audio {

namespace {

// IEC 60268-16:2011, table A.4: octaves of a male voice of 0 dB(A).
constexpr SpeechSpectrum kMaleDb = {2.9, 2.9, -0.8, -6.8, -12.8, -18.8, -24.8};

// Beranek 1957, as ANSI/ASA S12.2 and ASHRAE print them: NC-15, NC-20, ... NC-70.
constexpr double kCurveStep = 5.0;
constexpr std::array<SpeechSpectrum, 12> kNoiseCriteria = {{{36, 29, 22, 17, 14, 12, 11},
                                                            {40, 33, 26, 22, 19, 17, 16},
                                                            {44, 37, 31, 27, 24, 22, 21},
                                                            {48, 41, 35, 31, 29, 28, 27},
                                                            {52, 45, 40, 36, 34, 33, 32},
                                                            {56, 50, 45, 41, 39, 38, 37},
                                                            {60, 54, 49, 46, 44, 43, 42},
                                                            {64, 58, 54, 51, 49, 48, 47},
                                                            {67, 62, 58, 56, 54, 53, 52},
                                                            {71, 67, 63, 61, 59, 58, 57},
                                                            {75, 71, 68, 66, 64, 63, 62},
                                                            {79, 75, 72, 71, 70, 69, 68}}};

// Below what any ear or calculation notices.
constexpr double kNoNoiseDb = -200.0;

}  // namespace

SpeechSpectrum male_speech_db(double level_db) {
    SpeechSpectrum spectrum = kMaleDb;
    for (double& octave_db : spectrum) {
        octave_db += level_db;
    }
    return spectrum;
}

SpeechLevels levels_at_listener(const SpeechConditions& conditions, const SpeechSpectrum& energy) {
    SpeechLevels levels = {.speech_db = male_speech_db(conditions.speech_level_db)};
    if (!conditions.at_listener) {
        for (std::size_t band = 0; band < kSpeechBands; ++band) {
            levels.speech_db[band] += 10.0 * math::log10(energy[band]);
        }
    }
    levels.noise_db.fill(kNoNoiseDb);
    levels.noise_db = conditions.noise_db.value_or(levels.noise_db);
    return levels;
}

std::optional<SpeechSpectrum> noise_criterion_db(double number) {
    if (!(number >= kMinNoiseCriterion && number <= kMaxNoiseCriterion)) {
        return std::nullopt;
    }
    const double place = (number - kMinNoiseCriterion) / kCurveStep;
    const std::size_t below = std::min(static_cast<std::size_t>(place), kNoiseCriteria.size() - 2);
    const double share = place - static_cast<double>(below);
    SpeechSpectrum levels{};
    for (std::size_t band = 0; band < kSpeechBands; ++band) {
        levels[band] = kNoiseCriteria[below][band] +
                       share * (kNoiseCriteria[below + 1][band] - kNoiseCriteria[below][band]);
    }
    return levels;
}

}  // namespace earshot::audio
