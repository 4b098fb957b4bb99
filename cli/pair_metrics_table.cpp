// SPDX-License-Identifier: MIT
#include "earshot/cli/pair_metrics_table.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace earshot::cli {
namespace {

using Json = nlohmann::ordered_json;
using audio::BandMetrics;
using propagation::PairMetrics;

constexpr std::size_t kMaxRows = 40;
constexpr std::size_t kMaxNotes = 8;
constexpr std::size_t kNameWidth = 21;
constexpr std::size_t kColumnWidth = 12;

struct Column {
    const char* name;
    const char* unit;
    const char* key;                            // of the metric in metrics.json
    std::optional<double> BandMetrics::*value;  // none: the speech transmission index
    int decimals;
};

constexpr std::array<Column, 5> kColumns = {
    {{"T30", "s", "t30", &BandMetrics::reverberation_time_t30, 2},
     {"EDT", "s", "edt", &BandMetrics::early_decay_time, 2},
     {"C50", "dB", "c50", &BandMetrics::clarity_c50_db, 1},
     {"C80", "dB", "c80", &BandMetrics::clarity_c80_db, 1},
     {"STI", "", "sti", nullptr, 2}}};

std::optional<double> number(const audio::MetricValues& values, const Column& column) {
    return column.value == nullptr ? values.speech_transmission_index : values.mid.*column.value;
}

std::string fixed(double value, int decimals) {
    return formatted("%.*f", decimals, value);
}

/// To a width, with a blank at the end at least.
std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(width, text.size() + 1), ' ');
    return text;
}

/// `1.15+-0.012`: the error with one digit more than the value.
std::string cell(const audio::RoomMetrics& metrics, const Column& column) {
    const auto value = number(metrics, column);
    if (!value) {
        return padded("-", kColumnWidth);
    }
    const auto error = number(metrics.standard_error, column);
    return padded(
        fixed(*value, column.decimals) + (error ? "+-" + fixed(*error, column.decimals + 1) : ""),
        kColumnWidth);
}

std::string name_of(const ResponseJob& job, const PairMetrics& pair) {
    std::string name = on_one_line(job.scene.sources[pair.source].name) + " to " +
                       on_one_line(job.scene.listeners[pair.listener].name);
    return job.is_sequence ? name + " at " + fixed(pair.time, 3) + " s" : name;
}

/// A name too long for its column stands on a line of its own.
std::string row(const ResponseJob& job, const PairMetrics& pair) {
    std::string text = "  " + name_of(job, pair);
    text = text.size() < kNameWidth ? padded(text, kNameWidth)
                                    : text + "\n" + std::string(kNameWidth, ' ');
    for (const Column& column : kColumns) {
        text += cell(pair.expected, column);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
}

/// Why a number is missing: of the single number, of a band of it, or of all.
std::string reason(const std::vector<audio::MetricNote>& notes, const std::string& key) {
    constexpr double kMinHz = 390.0;
    constexpr double kMaxHz = 1300.0;
    const auto is_mid = [&](const audio::MetricNote& note) {
        return !note.band_hz || (*note.band_hz > kMinHz && *note.band_hz < kMaxHz);
    };
    for (const std::string& metric : {key + "_mid", key, std::string("all")}) {
        for (const audio::MetricNote& note : notes) {
            if (note.metric == metric && is_mid(note)) {
                return note.text;
            }
        }
    }
    return "see metrics.json";
}

/// Columns that lack a number for one reason stand together.
std::vector<std::string> reasons(const ResponseJob& job, const ResponseSummary& summary) {
    std::vector<std::string> lines;
    for (const PairMetrics& pair : summary.metrics) {
        std::vector<std::pair<std::string, std::string>> of_pair;  // titles, text
        for (const Column& column : kColumns) {
            if (number(pair.expected, column)) {
                continue;
            }
            const std::string title(column.name);
            const std::string text = reason(pair.expected.notes, column.key);
            if (!of_pair.empty() && of_pair.back().second == text) {
                of_pair.back().first += ", " + title;
            } else {
                of_pair.emplace_back(title, text);
            }
        }
        for (const auto& [titles, text] : of_pair) {
            lines.push_back(name_of(job, pair) + ", " + titles + ": " + text);
        }
    }
    return lines;
}

struct RoomTimes {
    double sabine = 0.0, eyring = 0.0;  // seconds, means of 500 Hz and 1 kHz
};

RoomTimes times_of(const ResponseJob& job, const propagation::RoomStatistics& room) {
    return {audio::mid_frequency_mean(job.simulation.bands, room.sabine),
            audio::mid_frequency_mean(job.simulation.bands, room.eyring)};
}

std::string room_text(const ResponseJob& job, const ResponseSummary& summary) {
    if (!summary.room) {
        return "";
    }
    const RoomTimes times = times_of(job, *summary.room);
    return "room       " + fixed(summary.room->volume, 0) + " m3, surface " +
           fixed(summary.room->surface, 0) + " m2, reverberation time by Sabine " +
           fixed(times.sabine, 2) + " s, by Eyring " + fixed(times.eyring, 2) + " s\n";
}

Json json_number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json numbers_json(const audio::MetricValues& values) {
    Json json = Json::object();
    for (const Column& column : kColumns) {
        const auto value = number(values, column);
        json[std::string(column.key) + (column.value == nullptr ? "" : "_mid")] =
            value ? Json(*value) : Json(nullptr);
    }
    return json;
}

}  // namespace

std::string pair_metrics_text(const ResponseJob& job, const ResponseSummary& summary) {
    if (summary.metrics.empty()) {
        return "";
    }
    std::string text = room_text(job, summary);
    text +=
        "metrics    mean of 500 Hz and 1 kHz, +- standard error\n" + std::string(kNameWidth, ' ');
    for (const Column& column : kColumns) {
        text += padded(std::string(column.name) + " " + column.unit, kColumnWidth);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
    const std::size_t rows = std::min(summary.metrics.size(), kMaxRows);
    for (std::size_t i = 0; i < rows; ++i) {
        text += row(job, summary.metrics[i]);
    }
    const auto more = [](std::size_t count) {
        return "  ... " + std::to_string(count) + " more in metrics.json\n";
    };
    if (summary.metrics.size() > rows) {
        text += more(summary.metrics.size() - rows);
    }
    const std::vector<std::string> lines = reasons(job, summary);
    for (std::size_t i = 0; i < std::min(lines.size(), kMaxNotes); ++i) {
        text += "  - " + lines[i] + "\n";
    }
    return lines.size() > kMaxNotes ? text + more(lines.size() - kMaxNotes) : text;
}

Json pair_metrics_json(const ResponseJob& job, const ResponseSummary& summary) {
    Json json = Json::object();
    if (summary.metrics.empty()) {
        return json;
    }
    json["room"] = nullptr;
    if (summary.room) {
        const RoomTimes times = times_of(job, *summary.room);
        json["room"] = {{"volume", summary.room->volume},
                        {"surface", summary.room->surface},
                        {"sabine_mid", json_number(times.sabine)},
                        {"eyring_mid", json_number(times.eyring)}};
    }
    json["metrics"] = Json::array();
    for (const PairMetrics& pair : summary.metrics) {
        Json record = {{"source", job.scene.sources[pair.source].name},
                       {"listener", job.scene.listeners[pair.listener].name},
                       {"time", pair.time}};
        record.update(numbers_json(pair.expected));
        record["standard_error"] = numbers_json(pair.expected.standard_error);
        json["metrics"].push_back(std::move(record));
    }
    return json;
}

}  // namespace earshot::cli
