// SPDX-License-Identifier: MIT
#include "earshot/audio/speech.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/modulation.h"
#include "earshot/audio/internal/modulation_kernel.h"
#include "earshot/audio/internal/noise_floor.h"
#include "earshot/audio/internal/speech_model.h"
#include "earshot/audio/speech_levels.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::audio {

namespace {

constexpr double kTurn = 6.283185307179586;

/// Energies over so short a time that the fastest modulation hardly changes in it: it is reduced by
/// less than 2e-5.
constexpr double kStep = 2.5e-4;  // seconds

std::vector<double> energy_per_step(std::span<const double> squared, double sample_rate) {
    const std::size_t length = samples_per_step(sample_rate);
    std::vector<double> energy;
    energy.reserve(squared.size() / length + 1);
    for (std::size_t begin = 0; begin < squared.size(); begin += length) {
        double sum = 0.0;
        for (std::size_t n = begin; n < std::min(begin + length, squared.size()); ++n) {
            sum += squared[n];
        }
        energy.push_back(sum);
    }
    return energy;
}

std::array<ModulationSums, kSpeechBands> sums_of_steps(std::span<const std::vector<double>> steps,
                                                       double sample_rate) {
    const double step = static_cast<double>(samples_per_step(sample_rate)) / sample_rate;
    std::size_t length = 0;
    for (const std::vector<double>& energy : steps) {
        length = std::max(length, energy.size());
    }
    constexpr std::size_t kRow = 8;
    length = (length + kRow - 1) / kRow * kRow;
    std::vector<double> padded(kSpeechBands * length, 0.0);
    std::array<ModulationSums, kSpeechBands> sums;
    std::array<const double*, kSpeechBands> rows{};
    for (std::size_t band = 0; band < kSpeechBands; ++band) {
        rows[band] = padded.data() + band * length;
        std::copy(steps[band].begin(), steps[band].end(), padded.data() + band * length);
        for (const double e : steps[band]) {
            sums[band].energy += e;
        }
    }
    // Sines and cosines cost most: all octaves share them.
    for (std::size_t k = 0; k < kModulationHz.size(); ++k) {
        const auto of_bands = fourier_sums(rows, length, kTurn * kModulationHz[k] * step);
        for (std::size_t band = 0; band < kSpeechBands; ++band) {
            sums[band].in_phase[k] = of_bands[band].in_phase;
            sums[band].in_quadrature[k] = of_bands[band].in_quadrature;
        }
    }
    return sums;
}

/// What is left of a modulation (Schroeder 1981).
double modulation_transfer(const ModulationSums& sums, std::size_t frequency) {
    const double in_phase = sums.in_phase[frequency];
    const double in_quadrature = sums.in_quadrature[frequency];
    return std::sqrt(in_phase * in_phase + in_quadrature * in_quadrature) / sums.energy;
}

/// How much of an octave comes before the cross point of its decay with the noise.
std::size_t size_before_noise(std::span<const double> squared,
                              std::size_t lead,
                              const ImpulseResponse& response,
                              double bandwidth_hz) {
    const std::span<const double> signal = squared.first(lead + response.samples.size());
    const auto loudest = std::max_element(signal.begin(), signal.end()) - signal.begin();
    const NoiseFloor floor = find_noise_floor({.squared = signal,
                                               .onset = static_cast<std::size_t>(loudest),
                                               .sample_rate = response.sample_rate,
                                               .bandwidth_hz = bandwidth_hz});
    return floor.energy > 0.0 ? floor.cross_point : squared.size();
}

}  // namespace

double masking_db(double level_db) {
    if (level_db < 63.0) {
        return 0.5 * level_db - 65.0;
    }
    if (level_db < 67.0) {
        return 1.8 * level_db - 146.9;
    }
    return level_db < 100.0 ? 0.5 * level_db - 59.8 : -10.0;
}

double level_factor(const SpeechLevels& levels, std::size_t band) {
    const auto total = [&](std::size_t k) {
        return intensity(levels.speech_db[k]) + intensity(levels.noise_db[k]);
    };
    double besides = intensity(kThresholdDb[band]);
    if (band > 0) {
        const double below_db = 10.0 * math::log10(total(band - 1));
        besides += intensity(below_db + masking_db(below_db));
    }
    return intensity(levels.speech_db[band]) / (total(band) + besides);
}

double transmission_index(double modulation) {
    if (modulation >= 1.0) {
        return 1.0;
    }
    const double ratio_db =
        modulation > 0.0 ? 10.0 * math::log10(modulation / (1.0 - modulation)) : -kMaxRatioDb;
    return (std::clamp(ratio_db, -kMaxRatioDb, kMaxRatioDb) + kMaxRatioDb) / (2.0 * kMaxRatioDb);
}

std::size_t samples_per_step(double sample_rate) {
    return static_cast<std::size_t>(std::max(1.0, std::floor(kStep * sample_rate)));
}

std::array<ModulationSums, kSpeechBands> modulation_sums(
    std::span<const std::vector<double>> squared, double sample_rate) {
    EARSHOT_ASSERT(squared.size() == kSpeechBands && sample_rate > 0.0);
    std::array<std::vector<double>, kSpeechBands> steps;
    for (std::size_t band = 0; band < kSpeechBands; ++band) {
        steps[band] = energy_per_step(squared[band], sample_rate);
    }
    return sums_of_steps(steps, sample_rate);
}

void SpeechOctaves::set(std::size_t octave,
                        std::span<const double> squared,
                        std::size_t lead,
                        double unit_impulse_energy) {
    if (ends_in_noise_) {
        const Bands& bands = Bands::octaves();
        const std::size_t band = kFirstSpeechOctave + octave;
        const double bandwidth_hz = bands.upper_edge_hz(band) - bands.lower_edge_hz(band);
        squared = squared.first(size_before_noise(squared, lead, response_, bandwidth_hz));
    }
    steps_[octave] = energy_per_step(squared, response_.sample_rate);
    unit_impulse_energy_[octave] = unit_impulse_energy;
}

std::optional<SpeechTransmission> SpeechOctaves::transmission(
    const std::optional<SpeechConditions>& conditions) const {
    const auto octaves = sums_of_steps(steps_, response_.sample_rate);
    SpeechSpectrum gain{};
    for (std::size_t band = 0; band < kSpeechBands; ++band) {
        if (!(octaves[band].energy > 0.0)) {
            return std::nullopt;
        }
        gain[band] = octaves[band].energy / unit_impulse_energy_[band];
    }
    return speech_transmission(
        octaves, conditions ? std::optional(levels_at_listener(*conditions, gain)) : std::nullopt);
}

SpeechTransmission speech_transmission(const std::array<ModulationSums, kSpeechBands>& octaves,
                                       const std::optional<SpeechLevels>& levels) {
    SpeechTransmission result;
    for (std::size_t band = 0; band < kSpeechBands; ++band) {
        const double factor = levels ? level_factor(*levels, band) : 1.0;
        for (std::size_t k = 0; k < kModulationHz.size(); ++k) {
            result.modulation[band] +=
                transmission_index(factor * modulation_transfer(octaves[band], k)) /
                static_cast<double>(kModulationHz.size());
        }
        result.index += kWeight[band] * result.modulation[band];
        if (band > 0) {
            result.index -= kRedundancy[band - 1] *
                            std::sqrt(result.modulation[band - 1] * result.modulation[band]);
        }
    }
    result.index = std::clamp(result.index, 0.0, 1.0);
    return result;
}

static_assert(kModulationBands == kSpeechBands);

SpeechTransmission speech_transmission(std::span<const std::vector<double>> squared,
                                       double sample_rate,
                                       const std::optional<SpeechLevels>& levels) {
    return speech_transmission(modulation_sums(squared, sample_rate), levels);
}

std::optional<SpeechTransmission> speech_transmission(
    const ImpulseResponse& response,
    const std::optional<SpeechConditions>& conditions,
    bool ends_in_noise) {
    return speech_transmission(response, conditions, ends_in_noise, FilterCache());
}

std::optional<SpeechTransmission> speech_transmission(
    const ImpulseResponse& response,
    const std::optional<SpeechConditions>& conditions,
    bool ends_in_noise,
    const FilterCache& cache) {
    if (response.samples.empty()) {
        return std::nullopt;
    }
    const BandEnergy filters(Bands::octaves(), response.samples, response.sample_rate, cache);
    SpeechOctaves octaves(response, ends_in_noise);
    std::vector<double> squared;
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        const std::size_t band = kFirstSpeechOctave + octave;
        if (!filters.covers(band)) {
            return std::nullopt;
        }
        squared = filters.squared(band, std::move(squared));
        octaves.set(octave, squared, filters.lead(), filters.of_unit_impulse(band));
    }
    return octaves.transmission(conditions);
}

std::string_view sti_letter(double index) noexcept {
    constexpr double kTop = 0.76;
    constexpr std::array<std::pair<double, std::string_view>, 10> kLowerLimits = {{{0.72, "A"},
                                                                                   {0.68, "B"},
                                                                                   {0.64, "C"},
                                                                                   {0.60, "D"},
                                                                                   {0.56, "E"},
                                                                                   {0.52, "F"},
                                                                                   {0.48, "G"},
                                                                                   {0.44, "H"},
                                                                                   {0.40, "I"},
                                                                                   {0.36, "J"}}};
    if (index > kTop) {
        return "A+";
    }
    for (const auto& [lower, letter] : kLowerLimits) {
        if (index >= lower) {
            return letter;
        }
    }
    return "U";
}

}  // namespace earshot::audio
