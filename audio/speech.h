// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/impulse_response.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace earshot::audio {

/// The octaves of speech: 125 Hz ... 8 kHz.
inline constexpr std::size_t kSpeechBands = 7;
using SpeechSpectrum = std::array<double, kSpeechBands>;

/// Levels at the listener per octave, decibels re 20 micropascal.
struct SpeechLevels {
    SpeechSpectrum speech_db{};
    SpeechSpectrum noise_db{};
};

/// How loud speech and noise are.
struct SpeechConditions {
    /// A-weighted level of a voice of the male spectrum, decibels: 1 m in front of the talker in
    /// free field, or at the listener.
    double speech_level_db = 60.0;
    bool at_listener = false;
    /// Per octave, at the listener; empty: there is none.
    std::optional<SpeechSpectrum> noise_db{};
};

struct SpeechTransmission {
    double index = 0.0;           ///< STI, 0 ... 1
    SpeechSpectrum modulation{};  ///< modulation transfer index per octave, 0 ... 1
};

/// Speech transmission index (IEC 60268-16:2011, male spectrum) from the squared impulse response
/// of each octave (Schroeder 1981): over 14 modulation frequencies from 0.63 to 12.5 Hz. With
/// levels, noise, the masking of an octave by the one below and the threshold of hearing reduce the
/// modulation (annex A); without, speech is loud and the room quiet. Preconditions: kSpeechBands
/// entries, each with a positive sample and none negative; sample_rate > 0.
SpeechTransmission speech_transmission(std::span<const std::vector<double>> squared,
                                       double sample_rate,
                                       const std::optional<SpeechLevels>& levels = {});

/// The same of an impulse response, which must hold the whole decay. Nothing if an octave is silent
/// or reaches past half the sample rate (23 kHz is enough). `ends_in_noise`: the response was
/// measured; what lies behind the point where an octave's decay sinks into steady noise is left
/// out.
std::optional<SpeechTransmission> speech_transmission(
    const ImpulseResponse& response,
    const std::optional<SpeechConditions>& conditions = {},
    bool ends_in_noise = false);
/// The same with filters that are kept.
std::optional<SpeechTransmission> speech_transmission(
    const ImpulseResponse& response,
    const std::optional<SpeechConditions>& conditions,
    bool ends_in_noise,
    const FilterCache& cache);

/// Qualification band of an index, "A+" (above 0.76), "A", "B", ... "J", each 0.04 lower, and "U"
/// (below 0.36): IEC 60268-16:2011, annex F. An index on a limit belongs to the higher band,
/// but 0.76 is "A".
std::string_view sti_letter(double index) noexcept;

}  // namespace earshot::audio
