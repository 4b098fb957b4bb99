// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/speech.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

inline constexpr std::size_t kFirstSpeechOctave = 2;  // 125 Hz among Bands::octaves()

/// IEC 60268-16:2011, clause 4.
inline constexpr std::array<double, 14> kModulationHz = {
    0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, 10.0, 12.5};

/// An octave's energy and its Fourier sums at the modulation frequencies.
struct ModulationSums {
    double energy = 0.0;
    std::array<double, kModulationHz.size()> in_phase{};
    std::array<double, kModulationHz.size()> in_quadrature{};
};

/// Of each octave.
std::array<ModulationSums, kSpeechBands> modulation_sums(
    std::span<const std::vector<double>> squared, double sample_rate);

/// The index of the octaves. Precondition: each has energy.
SpeechTransmission speech_transmission(const std::array<ModulationSums, kSpeechBands>& octaves,
                                       const std::optional<SpeechLevels>& levels);

}  // namespace earshot::audio
