// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/speech.h"

#include <optional>

namespace earshot::audio {

/// A-weighted levels 1 m in front of a talker (ISO 9921:2003, table A.1), decibels.
inline constexpr double kNormalSpeechDb = 60.0;
inline constexpr double kRaisedSpeechDb = 66.0;
inline constexpr double kLoudSpeechDb = 72.0;

/// Octave levels of male speech (IEC 60268-16:2011, annex A) of an A-weighted level, decibels.
SpeechSpectrum male_speech_db(double level_db);

/// Levels at a listener who receives `energy` per octave, in units of the talker's free field at
/// 1 m in front.
SpeechLevels levels_at_listener(const SpeechConditions& conditions, const SpeechSpectrum& energy);

inline constexpr double kMinNoiseCriterion = 15.0;
inline constexpr double kMaxNoiseCriterion = 70.0;

/// Octave levels of the noise criterion curve NC-`number` (Beranek 1957; ANSI/ASA S12.2),
/// interpolated between the curves, which stand 5 apart. Nothing outside kMinNoiseCriterion ...
/// kMaxNoiseCriterion.
std::optional<SpeechSpectrum> noise_criterion_db(double number);

}  // namespace earshot::audio
