// SPDX-License-Identifier: MIT
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/text.h"
#include "earshot/io/metrics.h"

#include <string>
#include <string_view>

namespace earshot::io {
namespace {

std::string field(const std::optional<double>& value) {
    return "," + (value ? json_number(*value) : std::string());
}

/// The value of a band, empty where the file has no such list.
std::string field(const std::vector<std::optional<double>>* values, std::size_t band) {
    return field(values != nullptr ? (*values)[band] : std::nullopt);
}

/// What the notes on a band, or on all of them, say.
std::string notes_on(const ChannelMetrics& channel, double band_hz) {
    std::string text;
    for (const audio::MetricNote& note : channel.metrics.notes) {
        if (!note.band_hz || *note.band_hz == band_hz) {
            text += (text.empty() ? "" : "; ") + note.metric + ": " + note.text;
        }
    }
    return text;
}

std::string row(const SoundMetrics& sound,
                const ChannelMetrics& channel,
                const audio::Bands& bands,
                std::size_t band) {
    const audio::RoomMetrics& metrics = channel.metrics;
    const double band_hz = bands.nominal_hz()[band];
    std::string text =
        csv_field(sound.file) + "," + std::to_string(channel.channel) + "," + json_number(band_hz);
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        text += field(metrics.bands[band].*kind.value);
    }
    const audio::BandNoise noise = metrics.noise.empty() ? audio::BandNoise{} : metrics.noise[band];
    text += field(noise.level_db) + field(noise.peak_to_noise_db);
    text += field(channel.support ? &channel.support->early_db : nullptr, band) +
            field(channel.support ? &channel.support->late_db : nullptr, band);
    text += field(sound.lateral ? &sound.lateral->lateral_fraction : nullptr, band) +
            field(sound.late_lateral ? &sound.late_lateral->level_db : nullptr, band);
    text += field(sound.binaural ? &sound.binaural->iacc_early : nullptr, band) +
            field(sound.binaural ? &sound.binaural->iacc_late : nullptr, band) +
            field(sound.binaural ? &sound.binaural->iacc : nullptr, band);
    text +=
        field(metrics.speech_transmission_index) + field(channel.bass_ratio) + field(channel.onset);
    return text + "," + csv_field(notes_on(channel, band_hz)) + "\n";
}

}  // namespace

std::string encode_metrics_table(const audio::Bands& bands, std::span<const SoundMetrics> files) {
    std::string text = "file,channel,band_hz";
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        text += "," + std::string(kind.key);
    }
    text +=
        ",noise_level,peak_to_noise,st_early,st_late,lf,lj,iacc_early,iacc_late,iacc,sti,"
        "bass_ratio,onset,notes\n";
    for (const SoundMetrics& sound : files) {
        for (const ChannelMetrics& channel : sound.channels) {
            for (std::size_t band = 0; band < bands.count(); ++band) {
                text += row(sound, channel, bands, band);
            }
        }
    }
    return text;
}

}  // namespace earshot::io
