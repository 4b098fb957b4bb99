// SPDX-License-Identifier: MIT
#include "earshot/audio/measured_metrics.h"

#include "earshot/audio/internal/hum.h"
#include "earshot/audio/internal/onset.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace earshot::audio {

namespace {

// Clipped by 12 dB, samples of this share of the energy would have raised it by 15 %, 0.6 dB.
constexpr double kMaxClippedShare = 0.01;
// T20 and T30 are read from 5 dB below the start of the decay on.
constexpr double kTimesBeginDb = -5.0;
constexpr double kMinHumShare = 0.5;  // of a band's noise
constexpr double kMinPeakToHumDb = 40.0;
// A band is one of seven of the index.
constexpr double kMinPeakToHumOfSpeechDb = 30.0;
constexpr double kMinSpeechHz = 90.0;

void refuse_clipped(const Clipping& clipping, RoomMetrics& metrics) {
    if (!(clipping.energy_share > kMaxClippedShare)) {
        return;
    }
    const bool times_are_kept = clipping.energy_after_db >= kTimesBeginDb;
    for (const BandMetricKind& kind : kBandMetricKinds) {
        const bool is_late = kind.value == &BandMetrics::reverberation_time_t20 ||
                             kind.value == &BandMetrics::reverberation_time_t30;
        if (is_late && times_are_kept) {
            continue;
        }
        for (BandMetrics& band : metrics.bands) {
            (band.*kind.value).reset();
        }
        metrics.notes.push_back(
            {.metric = std::string(kind.key), .band_hz = {}, .text = "the response is clipped"});
    }
    metrics.speech_transmission_index.reset();
    metrics.notes.push_back({.metric = "sti", .band_hz = {}, .text = "the response is clipped"});
}

/// Names the bands whose noise is hum, and empties those in which it is not low: other than noise
/// it adds to the decay with one phase for all of its time.
void refuse_hum(const Bands& bands, const ImpulseResponse& response, RoomMetrics& metrics) {
    const Hum hum = find_hum(bands, response.samples, response.sample_rate);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const auto& peak_to_noise_db = metrics.noise[band].peak_to_noise_db;
        if (hum.noise_share[band] < kMinHumShare || !peak_to_noise_db) {
            continue;
        }
        const double nominal_hz = bands.nominal_hz()[band];
        const std::string text = "mains hum of " + std::to_string(std::lround(hum.mains_hz)) +
                                 " Hz and its harmonics, " +
                                 std::to_string(std::lround(*peak_to_noise_db)) +
                                 " dB below the decay's start";
        const bool refused = *peak_to_noise_db < kMinPeakToHumDb;
        metrics.notes.push_back(
            {.metric = refused ? "all" : "peak_to_noise", .band_hz = nominal_hz, .text = text});
        if (refused) {
            metrics.bands[band] = {};
        }
        if (*peak_to_noise_db < kMinPeakToHumOfSpeechDb && nominal_hz > kMinSpeechHz &&
            metrics.speech_transmission_index) {
            metrics.speech_transmission_index.reset();
            metrics.notes.push_back({.metric = "sti", .band_hz = nominal_hz, .text = text});
        }
    }
}

}  // namespace

std::optional<std::size_t> direct_sound(const ImpulseResponse& response) {
    return find_onset(response.samples);
}

void calibrate_strength(const Bands& bands,
                        const std::optional<StrengthCorrection>& correction_db,
                        RoomMetrics& metrics) {
    EARSHOT_ASSERT(!correction_db || correction_db->size() == bands.count());
    if (!correction_db) {
        for (BandMetrics& band : metrics.bands) {
            band.strength_db.reset();
        }
        metrics.notes.push_back(
            {.metric = "g", .band_hz = {}, .text = "the response is not calibrated"});
    }
    for (std::size_t band = 0; correction_db && band < metrics.bands.size(); ++band) {
        auto& strength_db = metrics.bands[band].strength_db;
        if (strength_db && (*correction_db)[band]) {
            *strength_db += *(*correction_db)[band];
        } else if (strength_db) {
            strength_db.reset();
            metrics.notes.push_back({.metric = "g",
                                     .band_hz = bands.nominal_hz()[band],
                                     .text = "the recording in free field gives no level"});
        }
    }
    metrics.mid = mid_frequency_means(bands, metrics.bands);
}

MeasuredMetrics measured_metrics(const Bands& bands,
                                 const ImpulseResponse& recording,
                                 const MeasuredOptions& options) {
    MeasuredMetrics measured{.metrics = {}, .part = measured_response(recording, options.onset)};
    if (!measured.part) {
        measured.metrics = response_metrics(bands, {recording.sample_rate, {}});
        return measured;
    }
    const MeasuredResponse& part = *measured.part;
    RoomMetrics& metrics = measured.metrics;
    metrics = response_metrics(bands,
                               part.response,
                               {.ends_in_noise = true,
                                .withhold_uncertain = true,
                                .full_decay = false,
                                .onset = part.onset - part.begin,
                                .speech = options.speech});
    metrics.notes.insert(metrics.notes.begin(), part.notes.begin(), part.notes.end());
    calibrate_strength(bands, options.strength_correction_db, metrics);
    refuse_clipped(part.clipping, metrics);
    refuse_hum(bands, part.response, metrics);
    metrics.mid = mid_frequency_means(bands, metrics.bands);
    return measured;
}

StrengthCorrection strength_correction_db(const Bands& bands,
                                          const ImpulseResponse& free_field,
                                          double distance) {
    EARSHOT_ASSERT(distance > 0.0);
    constexpr double kStrengthDistance = 10.0;  // metres
    const MeasuredMetrics measured =
        measured_metrics(bands,
                         free_field,
                         {.onset = {},
                          .strength_correction_db = StrengthCorrection(bands.count(), 0.0),
                          .speech = {}});
    StrengthCorrection correction_db(bands.count());
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (const auto& level_db = measured.metrics.bands[band].strength_db) {
            correction_db[band] = -*level_db - 20.0 * math::log10(distance / kStrengthDistance);
        }
    }
    return correction_db;
}

std::optional<double> bass_ratio(const Bands& bands, const RoomMetrics& metrics) {
    const auto mean = [&](std::optional<double> BandMetrics::*time,
                          double from_hz,
                          double to_hz) -> std::optional<double> {
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t band = 0; band < bands.count(); ++band) {
            if (bands.nominal_hz()[band] > from_hz && bands.nominal_hz()[band] < to_hz) {
                if (!(metrics.bands[band].*time)) {
                    return std::nullopt;
                }
                sum += *(metrics.bands[band].*time);
                count += 1.0;
            }
        }
        return sum / count;
    };
    for (const auto time :
         {&BandMetrics::reverberation_time_t30, &BandMetrics::reverberation_time_t20}) {
        const auto low = mean(time, 95.0, 330.0);
        const auto middle = mean(time, 390.0, 1300.0);
        if (low && middle) {
            return *low / *middle;
        }
    }
    return std::nullopt;
}

}  // namespace earshot::audio
