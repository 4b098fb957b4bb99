// SPDX-License-Identifier: MIT
#include "earshot/audio/response_metrics.h"

#include "earshot/audio/internal/band_course.h"
#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/audio/internal/modulation.h"
#include "earshot/audio/internal/onset.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::audio {

namespace {

/// Splits a response into bands once, for its metrics and, if the bands are octaves, for speech.
class ResponseBands {
public:
    ResponseBands(const Bands& bands,
                  const ImpulseResponse& response,
                  const MetricsOptions& options,
                  const FilterCache& cache)
        : bands_(bands),
          response_(response),
          options_(options),
          cache_(cache),
          energy_(bands, response.samples, response.sample_rate, cache),
          octaves_(response, options.ends_in_noise) {}

    void read(std::size_t band,
              std::size_t onset,
              double after_onset,
              MetricsReader& reader,
              RoomMetrics& metrics) {
        if (!energy_.covers(band)) {
            reader.note_band(band, "the band reaches past half the sample rate");
            return;
        }
        std::vector<double> squared = energy_.squared(band, std::move(memory_));
        const double reference = energy_.of_unit_impulse(band);
        if (are_octaves() && band >= kFirstSpeechOctave &&
            band < kFirstSpeechOctave + kSpeechBands) {
            octaves_.set(band - kFirstSpeechOctave, squared, energy_.lead(), reference);
        }
        const double bandwidth_hz = bands_.upper_edge_hz(band) - bands_.lower_edge_hz(band);
        BandCourse course = band_course(std::move(squared),
                                        energy_.lead(),
                                        bandwidth_hz,
                                        response_,
                                        onset,
                                        options_.ends_in_noise);
        if (std::all_of(
                course.squared.begin(), course.squared.end(), [](double e) { return e == 0.0; })) {
            reader.note_band(band, "silent");
            return;
        }
        if (options_.ends_in_noise && course.noise.energy > 0.0) {
            metrics.noise[band] = {.level_db = 10.0 * math::log10(course.noise.energy),
                                   .peak_to_noise_db = course.noise.peak_to_noise_db};
        }
        metrics.bands[band] = reader.read(band,
                                          {.squared = course.squared,
                                           .onset = course.onset,
                                           .sample_rate = response_.sample_rate,
                                           .after_onset = after_onset,
                                           .reference = reference,
                                           .bandwidth_hz = bandwidth_hz,
                                           .noise = course.noise,
                                           .full_decay = options_.full_decay,
                                           .withhold_uncertain = options_.withhold_uncertain});
        memory_ = std::move(course.squared);
    }

    /// After all bands are read.
    std::optional<SpeechTransmission> speech() const {
        return are_octaves() ? octaves_.transmission(options_.speech)
                             : speech_transmission(
                                   response_, options_.speech, options_.ends_in_noise, cache_);
    }

private:
    bool are_octaves() const { return bands_.count() == Bands::octaves().count(); }

    const Bands& bands_;
    const ImpulseResponse& response_;
    const MetricsOptions& options_;
    const FilterCache& cache_;
    BandEnergy energy_;
    SpeechOctaves octaves_;
    std::vector<double> memory_;
};

}  // namespace

RoomMetrics response_metrics(const Bands& bands,
                             const ImpulseResponse& response,
                             const MetricsOptions& options) {
    return response_metrics(bands, response, options, FilterCache());
}

RoomMetrics response_metrics(const Bands& bands,
                             const ImpulseResponse& response,
                             const MetricsOptions& options,
                             const FilterCache& cache) {
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
    ResponseBands in_bands(bands, response, options, cache);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        in_bands.read(band, *onset, after_onset, reader, metrics);
    }
    metrics.mid = mid_frequency_means(bands, metrics.bands);
    if (reader.note_early_ends()) {
        return metrics;
    }
    if (const auto speech = in_bands.speech()) {
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
