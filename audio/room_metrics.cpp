// SPDX-License-Identifier: MIT
#include "earshot/audio/room_metrics.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/internal/onset.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

RoomMetrics room_metrics(const Bands& bands,
                         const ImpulseResponse& response,
                         const MetricsOptions& options) {
    RoomMetrics metrics;
    metrics.bands.resize(bands.count());
    std::vector<std::string>& notes = metrics.notes;
    const auto onset = find_onset(response.samples);
    if (!onset) {
        notes.emplace_back("the response is silent");
        return metrics;
    }
    const double after_onset =
        static_cast<double>(response.samples.size() - *onset) / response.sample_rate;
    MetricsReader reader(bands, notes);
    reader.note_extent(after_onset);
    const BandEnergy energy(bands, response.samples, response.sample_rate);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (!energy.covers(band)) {
            notes.push_back("all at " + band_name(bands, band) +
                            ": the band reaches past half the sample rate");
            continue;
        }
        std::vector<double> squared = energy.squared(band);
        if (std::all_of(squared.begin(), squared.end(), [](double e) { return e == 0.0; })) {
            notes.push_back("all at " + band_name(bands, band) + ": silent");
            continue;
        }
        const std::size_t begin = energy.lead() + *onset;
        NoiseFloor noise;
        if (options.ends_in_noise) {
            const std::span<const double> signal(squared.data(),
                                                 energy.lead() + response.samples.size());
            noise = find_noise_floor(signal, begin, response.sample_rate);
            squared.resize(noise.energy > 0.0 ? noise.cross_point : squared.size());
        }
        metrics.bands[band] =
            reader.read(band,
                        {.squared = squared,
                         .onset = begin,
                         .sample_rate = response.sample_rate,
                         .after_onset = after_onset,
                         .reference = energy.of_unit_impulse(band),
                         .bandwidth_hz = bands.upper_edge_hz(band) - bands.lower_edge_hz(band),
                         .noise = noise,
                         .full_decay = options.full_decay});
    }
    if (reader.note_early_ends()) {
        return metrics;
    }
    if (const auto speech = speech_transmission(response, options.speech, options.ends_in_noise)) {
        metrics.speech_transmission_index = speech->index;
    } else {
        notes.emplace_back(
            "sti: an octave from 125 Hz to 8 kHz is silent or reaches past half the sample rate");
    }
    return metrics;
}

namespace {

/// Whether a band belongs to the octaves 500 Hz and 1 kHz.
bool is_mid_frequency(const Bands& bands, std::size_t band) {
    constexpr double kMinHz = 390.0;
    constexpr double kMaxHz = 1300.0;
    return bands.nominal_hz()[band] > kMinHz && bands.nominal_hz()[band] < kMaxHz;
}

}  // namespace

std::optional<double> schroeder_frequency_hz(const Bands& bands,
                                             const RoomMetrics& metrics,
                                             double volume) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const BandMetrics& found = metrics.bands[band];
        const auto& longer = found.reverberation_time_t30 ? found.reverberation_time_t30
                                                          : found.reverberation_time_t20;
        const auto& time = longer ? longer : found.early_decay_time;
        if (time && is_mid_frequency(bands, band)) {
            sum += *time;
            count += 1.0;
        }
    }
    return count > 0.0 ? std::optional(2000.0 * std::sqrt(sum / count / volume)) : std::nullopt;
}

std::optional<double> mid_frequency_mean(const Bands& bands,
                                         const RoomMetrics& metrics,
                                         std::optional<double> BandMetrics::*value) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t band = 0; band < metrics.bands.size(); ++band) {
        if (is_mid_frequency(bands, band)) {
            if (!(metrics.bands[band].*value)) {
                return std::nullopt;
            }
            sum += *(metrics.bands[band].*value);
            count += 1.0;
        }
    }
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace earshot::audio
