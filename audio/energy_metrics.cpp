// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/room_metrics.h"

#include <algorithm>

namespace earshot::audio {

namespace {

constexpr std::size_t kFirstSpeechOctave = 2;  // 125 Hz among Bands::octaves()
constexpr double kNoFilterHz = 1e9;            // bandwidth of energies: no filter rings
constexpr double kGridRate = 10000.0;          // of the grid that energies are put on, hertz

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
    const double steps = late.bin * kGridRate;
    for (std::size_t n = 0; n < late.energy.size(); ++n) {
        const auto from = static_cast<std::size_t>(static_cast<double>(n) * steps);
        const auto to =
            std::max(from + 1, static_cast<std::size_t>(static_cast<double>(n + 1) * steps));
        for (std::size_t i = from; i < std::min(to, energies.size()); ++i) {
            energies[i] += late.energy[n][band] / static_cast<double>(to - from);
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

RoomMetrics energy_metrics(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late) {
    RoomMetrics metrics;
    metrics.bands.resize(bands.count());
    if (arrivals.empty() && late.energy.empty()) {
        metrics.notes.emplace_back("the response is silent");
        return metrics;
    }
    MetricsReader reader(bands, metrics.notes);
    std::vector<std::vector<double>> energies;
    bool is_silent = false;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        energies.push_back(energies_of(band, arrivals, late));
        const std::vector<double>& squared = energies.back();
        const std::size_t onset = onset_of(squared);
        if (!(squared[onset] > 0.0)) {
            metrics.notes.push_back("all at " + band_name(bands, band) + ": silent");
            is_silent = true;
            continue;
        }
        const double after_onset = static_cast<double>(squared.size() - onset) / kGridRate;
        if (band == 0) {
            reader.note_extent(after_onset);
        }
        metrics.bands[band] = reader.read(band,
                                          {.squared = squared,
                                           .onset = onset,
                                           .sample_rate = kGridRate,
                                           .after_onset = after_onset,
                                           .bandwidth_hz = kNoFilterHz,
                                           .full_decay = late.full_decay});
    }
    if (reader.note_early_ends()) {
        return metrics;
    }
    if (is_silent || bands.count() != Bands::octaves().count()) {
        metrics.notes.emplace_back("sti: needs sound in octaves");
    } else {
        metrics.speech_transmission_index =
            speech_transmission(std::span(energies).subspan(kFirstSpeechOctave, kSpeechBands),
                                kGridRate)
                .index;
    }
    return metrics;
}

}  // namespace earshot::audio
