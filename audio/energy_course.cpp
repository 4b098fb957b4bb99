// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/energy_course.h"

#include <algorithm>

namespace earshot::audio {

namespace {

constexpr double kGridRate = 10000.0;  // of the grid that energies are put on, hertz

// Energy per instant of the grid.
std::vector<double> energies_of(std::size_t band,
                                std::span<const Arrival> arrivals,
                                const EnergyHistogram& late) {
    double end = late.bin * static_cast<double>(late.energy.size());
    for (const Arrival& arrival : arrivals) {
        end = std::max(end, arrival.delay);
    }
    std::vector<double> energies(static_cast<std::size_t>(end * kGridRate) + 2, 0.0);
    for (const Arrival& arrival : arrivals) {
        energies[static_cast<std::size_t>(arrival.delay * kGridRate)] +=
            arrival.pressure[band] * arrival.pressure[band];
    }
    for (std::size_t n = 0; n < late.energy.size(); ++n) {
        const Instants bin = instants_of_bin(late, n, kGridRate);
        for (std::size_t i = bin.begin; i < std::min(bin.end, energies.size()); ++i) {
            energies[i] += late.energy[n][band] / static_cast<double>(bin.end - bin.begin);
        }
    }
    return energies;
}

std::size_t onset_of(std::span<const double> energies) {
    constexpr double kBelow = 0.01;
    const double min_energy = kBelow * *std::max_element(energies.begin(), energies.end());
    std::size_t onset = 0;
    while (energies[onset] < min_energy) {
        ++onset;
    }
    return onset;
}

}  // namespace

OctaveBands bands_of_speech_octave(const Bands& bands, std::size_t octave) {
    constexpr std::size_t kFirstSpeechThird = 7;  // 100 Hz
    return bands.count() == Bands::octaves().count()
               ? OctaveBands{kFirstSpeechOctave + octave, 1}
               : OctaveBands{kFirstSpeechThird + 3 * octave, 3};
}

Instants instants_of_bin(const EnergyHistogram& late, std::size_t bin, double sample_rate) {
    const double steps = late.bin * sample_rate;
    const auto begin = static_cast<std::size_t>(static_cast<double>(bin) * steps);
    return {begin,
            std::max(begin + 1, static_cast<std::size_t>(static_cast<double>(bin + 1) * steps))};
}

EnergyCourse energy_course(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late) {
    EnergyCourse course = {.sample_rate = kGridRate};
    for (std::size_t band = 0; band < bands.count(); ++band) {
        course.energy.push_back(energies_of(band, arrivals, late));
        course.onset.push_back(onset_of(course.energy.back()));
    }
    return course;
}

std::optional<SpeechCourse> speech_course(const Bands& bands,
                                          const EnergyCourse& course,
                                          const std::optional<SpeechConditions>& conditions) {
    std::vector<std::vector<double>> octaves;
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        const OctaveBands parts = bands_of_speech_octave(bands, octave);
        std::vector<double>& energy = octaves.emplace_back(course.energy[parts.first].size());
        for (std::size_t i = 0; i < parts.count; ++i) {
            for (std::size_t n = 0; n < energy.size(); ++n) {
                energy[n] += course.energy[parts.first + i][n] / static_cast<double>(parts.count);
            }
        }
    }
    SpeechCourse speech = {.octaves = modulation_sums(octaves, course.sample_rate),
                           .conditions = conditions};
    const bool complete = std::all_of(speech.octaves.begin(),
                                      speech.octaves.end(),
                                      [](const ModulationSums& sums) { return sums.energy > 0.0; });
    return complete ? std::optional(speech) : std::nullopt;
}

}  // namespace earshot::audio
