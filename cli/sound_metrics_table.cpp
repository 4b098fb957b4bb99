// SPDX-License-Identifier: MIT
#include "earshot/cli/sound_metrics_table.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/note_lines.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace earshot::cli {
namespace {

using audio::BandMetrics;

struct Row {
    const char* name;
    std::optional<double> BandMetrics::*value;
    const char* format;
};

constexpr std::array<Row, 8> kRows = {{{"EDT s", &BandMetrics::early_decay_time, "%9.3f"},
                                       {"T20 s", &BandMetrics::reverberation_time_t20, "%9.3f"},
                                       {"T30 s", &BandMetrics::reverberation_time_t30, "%9.3f"},
                                       {"C50 dB", &BandMetrics::clarity_c50_db, "%9.2f"},
                                       {"C80 dB", &BandMetrics::clarity_c80_db, "%9.2f"},
                                       {"D50", &BandMetrics::definition_d50, "%9.3f"},
                                       {"Ts s", &BandMetrics::centre_time, "%9.4f"},
                                       {"G dB", &BandMetrics::strength_db, "%9.2f"}}};

std::string head_of(const std::string& text) {
    return text + std::string(8 - std::min<std::size_t>(8, text.size()), ' ');
}

std::string row_of(const std::string& name, const std::vector<std::optional<double>>& values) {
    std::string text = head_of(name);
    for (const auto& value : values) {
        text += value ? formatted("%9.3f", *value) : std::string(8, ' ') + "-";
    }
    return text + "\n";
}

std::string lines_of(const std::vector<audio::MetricNote>& notes) {
    std::string text;
    for (const std::string& note : note_lines(notes)) {
        text += "  " + note + "\n";
    }
    return text;
}

std::string heads(const audio::Bands& bands) {
    std::string text = head_of("Hz");
    for (const double frequency_hz : bands.nominal_hz()) {
        text += formatted("%9g", frequency_hz);
    }
    return text + "\n";
}

std::string noise_rows(const std::vector<audio::BandNoise>& noise) {
    if (noise.empty()) {
        return {};
    }
    std::vector<std::optional<double>> level_db;
    std::vector<std::optional<double>> peak_to_noise_db;
    for (const audio::BandNoise& band : noise) {
        level_db.push_back(band.level_db);
        peak_to_noise_db.push_back(band.peak_to_noise_db);
    }
    return row_of("noise", level_db) + row_of("peak/n", peak_to_noise_db);
}

/// A line per value, a column per band and one for the mean of 500 Hz and 1 kHz.
std::string table_of(const audio::Bands& bands, const io::ChannelMetrics& channel) {
    const audio::RoomMetrics& metrics = channel.metrics;
    std::string text = channel.onset ? formatted("onset   %9.4f s\n", *channel.onset) : "";
    text += heads(bands);
    text.insert(text.size() - 1, std::string(6, ' ') + "mid");
    for (const Row& row : kRows) {
        const auto cell = [&](const BandMetrics& band) {
            const auto& value = band.*row.value;
            return value ? formatted(row.format, *value) : std::string(8, ' ') + "-";
        };
        text += head_of(row.name);
        for (const BandMetrics& band : metrics.bands) {
            text += cell(band);
        }
        text += cell(metrics.mid) + "\n";
    }
    const auto& sti = metrics.speech_transmission_index;
    text += row_of("STI", {sti});
    if (sti) {
        text.insert(text.size() - 1, " " + std::string(audio::sti_letter(*sti)));
    }
    text += row_of("BR", {channel.bass_ratio}) + noise_rows(metrics.noise);
    if (const auto& support = channel.support) {
        text += row_of("STearly", support->early_db) + row_of("STlate", support->late_db) +
                row_of("STmean", {support->early_mean_db, support->late_mean_db}) +
                lines_of(support->notes);
    }
    return text + lines_of(metrics.notes);
}

std::string binaural_table(const audio::Bands& bands, const audio::BinauralMetrics& metrics) {
    return heads(bands) + row_of("IACC_E", metrics.iacc_early) +
           row_of("IACC_L", metrics.iacc_late) + row_of("IACC_A", metrics.iacc) +
           lines_of(metrics.notes);
}

}  // namespace

std::string sound_metrics_table(const audio::Bands& bands, const io::SoundMetrics& sound) {
    std::string text;
    for (const io::ChannelMetrics& channel : sound.channels) {
        text += (sound.channels.size() > 1 || channel.channel > 1
                     ? "channel " + std::to_string(channel.channel) + "\n"
                     : "") +
                table_of(bands, channel);
    }
    if (sound.binaural) {
        text += binaural_table(bands, *sound.binaural);
    }
    if (sound.lateral) {
        text += heads(bands) + row_of("LF", sound.lateral->lateral_fraction);
        if (sound.late_lateral) {
            text += row_of("LJ dB", sound.late_lateral->level_db) +
                    row_of("LJ mean", {sound.late_lateral->mean_db}) +
                    lines_of(sound.late_lateral->notes);
        }
        text += lines_of(sound.lateral->notes);
    }
    return text;
}

}  // namespace earshot::cli
