// SPDX-License-Identifier: MIT
#include "earshot/audio/response_metrics.h"

#include "earshot/audio/internal/band_course.h"
#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/internal/onset.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

RoomMetrics response_metrics(const Bands& bands,
                             const ImpulseResponse& response,
                             const MetricsOptions& options) {
    RoomMetrics metrics;
    metrics.bands.resize(bands.count());
    metrics.noise.resize(options.ends_in_noise ? bands.count() : 0);
    const auto onset = options.onset ? options.onset : find_onset(response.samples);
    if (!onset) {
        metrics.notes.push_back({.metric = "all", .text = "the response is silent"});
        return metrics;
    }
    const double after_onset =
        static_cast<double>(response.samples.size() - *onset) / response.sample_rate;
    MetricsReader reader(bands, metrics.notes);
    reader.note_extent(after_onset);
    const BandEnergy energy(bands, response.samples, response.sample_rate);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (!energy.covers(band)) {
            reader.note_band(band, "the band reaches past half the sample rate");
            continue;
        }
        const BandCourse course =
            band_course(bands, band, energy, response, *onset, options.ends_in_noise);
        if (std::all_of(
                course.squared.begin(), course.squared.end(), [](double e) { return e == 0.0; })) {
            reader.note_band(band, "silent");
            continue;
        }
        if (options.ends_in_noise && course.noise.energy > 0.0) {
            metrics.noise[band] = {.level_db = 10.0 * math::log10(course.noise.energy),
                                   .peak_to_noise_db = course.noise.peak_to_noise_db};
        }
        metrics.bands[band] =
            reader.read(band,
                        {.squared = course.squared,
                         .onset = course.onset,
                         .sample_rate = response.sample_rate,
                         .after_onset = after_onset,
                         .reference = energy.of_unit_impulse(band),
                         .bandwidth_hz = bands.upper_edge_hz(band) - bands.lower_edge_hz(band),
                         .noise = course.noise,
                         .full_decay = options.full_decay,
                         .withhold_uncertain = options.withhold_uncertain});
    }
    metrics.mid = mid_frequency_means(bands, metrics.bands);
    if (reader.note_early_ends()) {
        return metrics;
    }
    if (const auto speech = speech_transmission(response, options.speech, options.ends_in_noise)) {
        metrics.speech_transmission_index = speech->index;
    } else {
        metrics.notes.push_back(
            {.metric = "sti",
             .text =
                 "an octave from 125 Hz to 8 kHz is silent or reaches past half the sample rate"});
    }
    return metrics;
}

}  // namespace earshot::audio
