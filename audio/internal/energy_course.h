// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/internal/modulation.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

/// Energy that arrives over time, per band.
struct EnergyCourse {
    double sample_rate = 0.0;                   ///< of the grid, hertz
    std::vector<std::vector<double>> energy{};  ///< per band and instant
    std::vector<std::size_t> onset{};           ///< per band, an instant
};

/// What the speech transmission index of a course is computed from.
struct SpeechCourse {
    std::array<ModulationSums, kSpeechBands> octaves{};
    std::optional<SpeechConditions> conditions{};
};

/// The bands that an octave of speech is the mean of: itself, or three thirds.
struct OctaveBands {
    std::size_t first = 0;
    std::size_t count = 0;
};
OctaveBands bands_of_speech_octave(const Bands& bands, std::size_t octave);

/// The energies of arrivals and late sound on a grid. An arrival counts at the instant before it, a
/// bin is spread evenly over its instants.
EnergyCourse energy_course(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late);

/// Nothing if an octave is silent.
std::optional<SpeechCourse> speech_course(const Bands& bands,
                                          const EnergyCourse& course,
                                          const std::optional<SpeechConditions>& conditions);

/// The instants of a bin of late energy, begin and end.
struct Instants {
    std::size_t begin = 0, end = 0;
};
Instants instants_of_bin(const EnergyHistogram& late, std::size_t bin, double sample_rate);

}  // namespace earshot::audio
