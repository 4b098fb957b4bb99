// SPDX-License-Identifier: MIT
#include "earshot/audio/energy_metrics.h"

#include "earshot/audio/internal/energy_course.h"
#include "earshot/audio/internal/metric_errors.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/speech_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace earshot::audio {

namespace {

constexpr double kNoFilterHz = 1e9;  // bandwidth of energies: no filter rings

double index_of(const SpeechCourse& speech) {
    SpeechSpectrum energy{};
    for (std::size_t octave = 0; octave < kSpeechBands; ++octave) {
        energy[octave] = speech.octaves[octave].energy;
    }
    std::optional<SpeechLevels> levels;
    if (speech.conditions) {
        levels = levels_at_listener(*speech.conditions, energy);
    }
    return speech_transmission(speech.octaves, levels).index;
}

// Empties a value that is too uncertain and says so.
void withhold(const std::string& metric,
              const std::optional<double>& band_hz,
              double limit,
              std::string_view unit,
              const std::optional<double>& error,
              std::optional<double>& value,
              std::vector<MetricNote>& notes) {
    if (!value || !error || 2.0 * *error <= limit) {
        return;
    }
    std::array<char, 128> text{};
    std::snprintf(text.data(),
                  text.size(),
                  "standard error %.2g%s%.*s, at most %.2g allowed; more rays (--rays) reduce it",
                  *error,
                  unit.empty() ? "" : " ",
                  static_cast<int>(unit.size()),
                  unit.data(),
                  0.5 * limit);
    notes.push_back({.metric = metric, .band_hz = band_hz, .text = text.data()});
    value.reset();
}

void withhold_uncertain(const Bands& bands, RoomMetrics& metrics) {
    const auto withhold_kind = [&](const BandMetricKind& kind,
                                   const std::string& name,
                                   const std::optional<double>& band_hz,
                                   const BandMetrics& errors,
                                   BandMetrics& values) {
        std::optional<double>& value = values.*kind.value;
        const double limit =
            kind.just_noticeable_difference * (kind.relative ? value.value_or(0.0) : 1.0);
        withhold(name, band_hz, limit, kind.unit, errors.*kind.value, value, metrics.notes);
    };
    for (const BandMetricKind& kind : kBandMetricKinds) {
        const std::string key(kind.key);
        for (std::size_t band = 0; band < bands.count(); ++band) {
            withhold_kind(kind,
                          key,
                          bands.nominal_hz()[band],
                          metrics.standard_error.bands[band],
                          metrics.bands[band]);
        }
        withhold_kind(kind, key + "_mid", {}, metrics.standard_error.mid, metrics.mid);
    }
    withhold("sti",
             {},
             kSpeechJustNoticeableDifference,
             "",
             metrics.standard_error.speech_transmission_index,
             metrics.speech_transmission_index,
             metrics.notes);
}

}  // namespace

RoomMetrics energy_metrics(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late,
                           const EnergyMetricsOptions& options) {
    RoomMetrics metrics;
    metrics.bands.resize(bands.count());
    metrics.standard_error.bands.resize(bands.count());
    if (arrivals.empty() && late.energy.empty()) {
        metrics.notes.push_back({.metric = "all", .text = "the response is silent"});
        return metrics;
    }
    const EnergyCourse course = energy_course(bands, arrivals, late);
    MetricsReader reader(bands, metrics.notes);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const std::vector<double>& squared = course.energy[band];
        const std::size_t onset = course.onset[band];
        if (!(squared[onset] > 0.0)) {
            reader.note_band(band, "silent");
            continue;
        }
        const double after_onset = static_cast<double>(squared.size() - onset) / course.sample_rate;
        if (band == 0) {
            reader.note_extent(after_onset);
        }
        metrics.bands[band] = reader.read(band,
                                          {.squared = squared,
                                           .onset = onset,
                                           .sample_rate = course.sample_rate,
                                           .after_onset = after_onset,
                                           .bandwidth_hz = kNoFilterHz,
                                           .full_decay = late.full_decay});
    }
    metrics.mid = mid_frequency_means(bands, metrics.bands);

    std::optional<SpeechCourse> speech;
    if (!reader.note_early_ends()) {
        speech = speech_course(bands, course, options.speech);
        if (speech) {
            metrics.speech_transmission_index = index_of(*speech);
        } else {
            metrics.notes.push_back(
                {.metric = "sti", .text = "an octave from 125 Hz to 8 kHz is silent"});
        }
    }
    if (options.replicates != nullptr) {
        metrics.standard_error =
            metric_errors(bands, metrics, course, speech, *options.replicates, late.bin);
        withhold_uncertain(bands, metrics);
    }
    return metrics;
}

}  // namespace earshot::audio
