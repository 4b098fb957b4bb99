// SPDX-License-Identifier: MIT
// The chain rule through the speech transmission index (IEC 60268-16:2011), from the index back to
// the energies.
#include "earshot/audio/internal/speech_gradient.h"

#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/audio/internal/speech_model.h"
#include "earshot/audio/speech_levels.h"
#include "earshot/base/math.h"

#include <cmath>
#include <optional>

namespace earshot::audio {

namespace {

constexpr std::size_t kFrequencies = kModulationHz.size();

/// Slope of masking_db(), which is made of straight lines (table A.2).
double masking_slope(double level_db) {
    if (level_db < 63.0) {
        return 0.5;
    }
    if (level_db < 67.0) {
        return 1.8;
    }
    return level_db < 100.0 ? 0.5 : 0.0;
}

/// Slope of transmission_index().
double index_slope(double modulation) {
    if (!(modulation > 0.0 && modulation < 1.0)) {
        return 0.0;
    }
    const double ratio_db = 10.0 * math::log10(modulation / (1.0 - modulation));
    return std::abs(ratio_db) < kMaxRatioDb
               ? kDbPerLogEnergy / (modulation * (1.0 - modulation)) / (2.0 * kMaxRatioDb)
               : 0.0;
}

/// level_factor() of an octave, and its derivatives by its own energy and by that of the octave
/// below.
struct LevelFactor {
    double value = 1.0;
    double by_own = 0.0, by_below = 0.0;
};

LevelFactor level_factor_of(const SpeechLevels& levels,
                            const SpeechCourse& speech,
                            std::size_t octave) {
    LevelFactor factor = {.value = level_factor(levels, octave)};
    if (speech.conditions->at_listener) {
        return factor;  // levels do not follow the energies
    }
    // factor = own / all: of the intensities, speech is in proportion to the energy of its octave.
    const double own = intensity(levels.speech_db[octave]);
    const double all = own / factor.value;
    factor.by_own = own * (all - own) / (all * all) / speech.octaves[octave].energy;
    if (octave > 0) {
        const double below = intensity(levels.speech_db[octave - 1]);
        const double total = below + intensity(levels.noise_db[octave - 1]);
        const double total_db = 10.0 * math::log10(total);
        const double masking = intensity(total_db + masking_db(total_db));
        const double masking_by_below = masking * (1.0 + masking_slope(total_db)) / total * below /
                                        speech.octaves[octave - 1].energy;
        factor.by_below = -own / (all * all) * masking_by_below;
    }
    return factor;
}

/// Derivatives of the index by what it is computed from.
struct ModulationGradient {
    /// By the modulation transfer of each octave and frequency.
    std::array<std::array<double, kFrequencies>, kSpeechBands> by_transfer{};
    /// By the energy of each octave, through the levels alone.
    SpeechSpectrum by_energy{};
};

double size_of(const ModulationSums& sums, std::size_t frequency) {
    return std::sqrt(sums.in_phase[frequency] * sums.in_phase[frequency] +
                     sums.in_quadrature[frequency] * sums.in_quadrature[frequency]);
}

double transfer_of(const ModulationSums& sums, std::size_t frequency) {
    return size_of(sums, frequency) / sums.energy;
}

/// Derivatives of the index by the modulation transfer index of each octave; 0 where it is limited.
SpeechSpectrum by_octave(const SpeechTransmission& transmission) {
    SpeechSpectrum slopes{};
    if (!(transmission.index > 0.0 && transmission.index < 1.0)) {
        return slopes;
    }
    slopes = kWeight;
    for (std::size_t octave = 1; octave < kSpeechBands; ++octave) {
        const double below = transmission.modulation[octave - 1];
        const double own = transmission.modulation[octave];
        if (below > 0.0 && own > 0.0) {
            const double half = 0.5 * kRedundancy[octave - 1];
            slopes[octave - 1] -= half * std::sqrt(own / below);
            slopes[octave] -= half * std::sqrt(below / own);
        }
    }
    return slopes;
}

ModulationGradient modulation_gradient(const SpeechCourse& speech) {
    std::optional<SpeechLevels> levels;
    if (speech.conditions) {
        SpeechSpectrum energy{};
        for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
            energy[octave] = speech.octaves[octave].energy;
        }
        levels = levels_at_listener(*speech.conditions, energy);
    }
    const SpeechSpectrum slopes = by_octave(speech_transmission(speech.octaves, levels));
    ModulationGradient gradient;
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        const LevelFactor factor =
            levels ? level_factor_of(*levels, speech, octave) : LevelFactor{};
        for (std::size_t f = 0; f < kFrequencies; ++f) {
            const double transfer = transfer_of(speech.octaves[octave], f);
            const double slope = slopes[octave] / static_cast<double>(kFrequencies) *
                                 index_slope(factor.value * transfer);
            gradient.by_transfer[octave][f] = slope * factor.value;
            gradient.by_energy[octave] += slope * transfer * factor.by_own;
            if (octave > 0) {
                gradient.by_energy[octave - 1] += slope * transfer * factor.by_below;
            }
        }
    }
    return gradient;
}

}  // namespace

// The transfer is |c| / e, c the Fourier sum of the energies and e their sum (Schroeder 1981):
// energy at time t changes it by Re(c* exp(i w t)) / (|c| e) - |c| / e^2.
std::array<std::vector<double>, kSpeechBands> speech_gradient(const SpeechCourse& speech,
                                                              std::size_t steps,
                                                              double step) {
    const ModulationGradient gradient = modulation_gradient(speech);
    std::array<std::vector<double>, kSpeechBands> result;
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        double constant = gradient.by_energy[octave];
        for (std::size_t f = 0; f < kFrequencies; ++f) {
            constant -= gradient.by_transfer[octave][f] * transfer_of(speech.octaves[octave], f) /
                        speech.octaves[octave].energy;
        }
        result[octave].assign(steps, constant);
    }
    for (std::size_t f = 0; f < kFrequencies; ++f) {
        SpeechSpectrum in_phase{}, in_quadrature{};
        for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
            const ModulationSums& sums = speech.octaves[octave];
            const double size = size_of(sums, f);
            if (size > 0.0) {
                const double scale = gradient.by_transfer[octave][f] / (size * sums.energy);
                in_phase[octave] = scale * sums.in_phase[f];
                in_quadrature[octave] = scale * sums.in_quadrature[f];
            }
        }
        const double angle = 2.0 * math::kPi * kModulationHz[f] * step;
        for (std::size_t n = 0; n < steps; ++n) {
            const double cosine = math::cos(angle * static_cast<double>(n));
            const double sine = math::sin(angle * static_cast<double>(n));
            for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
                result[octave][n] += in_phase[octave] * cosine + in_quadrature[octave] * sine;
            }
        }
    }
    return result;
}

}  // namespace earshot::audio
