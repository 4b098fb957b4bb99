// SPDX-License-Identifier: MIT
#include "earshot/audio/room_metrics.h"

#include <cmath>
#include <cstddef>

namespace earshot::audio {

namespace {

/// Whether a band belongs to the octaves 500 Hz and 1 kHz.
bool is_mid_frequency(const Bands& bands, std::size_t band) {
    constexpr double kMinHz = 390.0;
    constexpr double kMaxHz = 1300.0;
    return bands.nominal_hz()[band] > kMinHz && bands.nominal_hz()[band] < kMaxHz;
}

}  // namespace

BandMetrics mid_frequency_means(const Bands& bands, std::span<const BandMetrics> values) {
    BandMetrics means;
    for (const BandMetricKind& kind : kBandMetricKinds) {
        double sum = 0.0;
        double count = 0.0;
        bool complete = true;
        for (std::size_t band = 0; band < values.size(); ++band) {
            if (is_mid_frequency(bands, band)) {
                const std::optional<double>& value = values[band].*kind.value;
                complete = complete && value;
                sum += value.value_or(0.0);
                count += 1.0;
            }
        }
        if (complete && count > 0.0) {
            means.*kind.value = sum / count;
        }
    }
    return means;
}

double mid_frequency_mean(const Bands& bands, std::span<const double> values) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (is_mid_frequency(bands, band)) {
            sum += values[band];
            count += 1.0;
        }
    }
    return sum / count;
}

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

}  // namespace earshot::audio
