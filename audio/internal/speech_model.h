// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/speech.h"
#include "earshot/base/math.h"

#include <array>

namespace earshot::audio {

// IEC 60268-16:2011, tables A.1 and A.3.
inline constexpr SpeechSpectrum kWeight = {0.085, 0.127, 0.230, 0.233, 0.309, 0.224, 0.173};
inline constexpr std::array<double, kSpeechBands - 1> kRedundancy = {
    0.085, 0.078, 0.065, 0.011, 0.047, 0.095};
inline constexpr SpeechSpectrum kThresholdDb = {46.0, 27.0, 12.0, 6.5, 7.5, 8.0, 12.0};
inline constexpr double kMaxRatioDb = 15.0;

inline double intensity(double level_db) {
    return math::pow10(level_db / 10.0);
}

/// How far below an octave's level the masking of the next octave lies (table A.2).
double masking_db(double level_db);

/// What noise, masking and the threshold of hearing leave of any modulation in an octave.
double level_factor(const SpeechLevels& levels, std::size_t band);

/// Of a modulation transfer ratio, 0 ... 1.
double transmission_index(double modulation);

}  // namespace earshot::audio
