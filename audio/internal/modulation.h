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

/// Samples of which modulation_sums() adds the energies up before it looks at their modulation.
std::size_t samples_per_step(double sample_rate);

/// Of each octave's energy per sample.
std::array<ModulationSums, kSpeechBands> modulation_sums(
    std::span<const std::vector<double>> squared, double sample_rate);

/// The octaves of speech of a response, each reduced to energies over so short times that no
/// modulation changes in them.
class SpeechOctaves {
public:
    /// `ends_in_noise`: what lies behind the point where an octave's decay sinks into steady noise
    /// is left out.
    SpeechOctaves(const ImpulseResponse& response, bool ends_in_noise)
        : response_(response), ends_in_noise_(ends_in_noise) {}

    /// `squared`: per sample of Bands::octaves()[kFirstSpeechOctave + octave]; sample n of the
    /// response is sample n + lead. `unit_impulse_energy`: of a response that is one sample of 1.
    void set(std::size_t octave,
             std::span<const double> squared,
             std::size_t lead,
             double unit_impulse_energy);
    /// Nothing if an octave is silent or was not set.
    std::optional<SpeechTransmission> transmission(
        const std::optional<SpeechConditions>& conditions) const;

private:
    const ImpulseResponse& response_;
    bool ends_in_noise_;
    std::array<std::vector<double>, kSpeechBands> steps_;
    SpeechSpectrum unit_impulse_energy_{};
};

/// The index of the octaves. Precondition: each has energy.
SpeechTransmission speech_transmission(const std::array<ModulationSums, kSpeechBands>& octaves,
                                       const std::optional<SpeechLevels>& levels);

}  // namespace earshot::audio
