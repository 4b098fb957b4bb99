// SPDX-License-Identifier: MIT
#include "earshot/io/metrics.h"

#include "earshot/base/assert.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/pair_head.h"

#include <cmath>
#include <span>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;  // keys in the order of the contract
using audio::BandMetricKind;
using audio::kBandMetricKinds;

Json to_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json to_json(std::span<const double> values) {
    Json json = Json::array();
    for (const double value : values) {
        json.push_back(std::isfinite(value) ? Json(value) : Json(nullptr));
    }
    return json;
}

Json to_json(const std::vector<std::optional<double>>& values) {
    Json json = Json::array();
    for (const auto& value : values) {
        json.push_back(to_json(value));
    }
    return json;
}

Json to_json(const std::vector<audio::MetricNote>& notes) {
    Json json = Json::array();
    for (const audio::MetricNote& note : notes) {
        json.push_back(
            {{"metric", note.metric}, {"band_hz", to_json(note.band_hz)}, {"text", note.text}});
    }
    return json;
}

/// A list per metric, one number per band, and the index.
Json per_band(const audio::MetricValues& values) {
    Json json = Json::object();
    for (const BandMetricKind& kind : kBandMetricKinds) {
        Json column = Json::array();
        for (const audio::BandMetrics& band : values.bands) {
            column.push_back(to_json(band.*kind.value));
        }
        json[std::string(kind.key)] = std::move(column);
    }
    json["sti"] = to_json(values.speech_transmission_index);
    return json;
}

Json single(const audio::BandMetrics& mid) {
    Json json = Json::object();
    for (const BandMetricKind& kind : kBandMetricKinds) {
        json[std::string(kind.key) + "_mid"] = to_json(mid.*kind.value);
    }
    return json;
}

/// Values, letter and single numbers.
Json to_json(const audio::RoomMetrics& metrics) {
    Json json = per_band(metrics);
    const auto& index = metrics.speech_transmission_index;
    json["sti_letter"] = index ? Json(audio::sti_letter(*index)) : Json(nullptr);
    json["single"] = single(metrics.mid);
    return json;
}

/// Metrics of several channels; their notes join the others.
void add_spatial(const std::optional<audio::LateralMetrics>& lateral,
                 const std::optional<audio::BinauralMetrics>& binaural,
                 Json& json) {
    const auto add_notes = [&](const std::vector<audio::MetricNote>& notes) {
        for (const Json& note : to_json(notes)) {
            json["notes"].push_back(note);
        }
    };
    if (lateral) {
        json["lf"] = to_json(lateral->lateral_fraction);
        add_notes(lateral->notes);
    }
    if (binaural) {
        json["iacc_early"] = to_json(binaural->iacc_early);
        json["iacc_late"] = to_json(binaural->iacc_late);
        json["iacc"] = to_json(binaural->iacc);
        add_notes(binaural->notes);
    }
}

void add_speech(const std::optional<audio::SpeechConditions>& speech, Json& json) {
    if (speech) {
        json["speech_level"] = speech->speech_level_db;
        json["noise"] = speech->noise_db ? to_json(*speech->noise_db) : Json(nullptr);
    }
}

Json to_json(const propagation::RoomStatistics& room, std::size_t bands) {
    return {{"volume", room.volume},
            {"surface", room.surface},
            {"opening", room.opening},
            {"sabine", to_json(std::span(room.sabine).first(bands))},
            {"eyring", to_json(std::span(room.eyring).first(bands))}};
}

Json to_json(const propagation::PairMetrics& pair) {
    Json json = to_json(pair.expected);
    Json errors = per_band(pair.expected.standard_error);
    errors["single"] = single(pair.expected.standard_error.mid);
    json["standard_error"] = std::move(errors);
    json["response"] = to_json(pair.response);
    json["response"]["notes"] = to_json(pair.response.notes);
    json["schroeder_hz"] = to_json(pair.schroeder_hz);
    json["notes"] = to_json(pair.expected.notes);
    add_spatial(pair.lateral, pair.binaural, json);
    return json;
}

/// `"a":1,` without braces; nothing of an empty object.
std::string members(const Json& object) {
    const std::string text = json_text(object);
    return object.empty() ? "" : text.substr(1, text.size() - 2) + ",";
}

}  // namespace

std::string encode_metrics(const MetricsHeader& header,
                           const std::vector<propagation::PairMetrics>& pairs) {
    Json head = {{"version", 2}, {"bands_hz", to_json(header.bands.nominal_hz())}};
    head["room"] = header.room ? to_json(*header.room, header.bands.count()) : Json(nullptr);
    add_speech(header.speech, head);
    JsonLines lines;
    lines.begin_list("{" + members(head) + "\n\"pairs\":", 1);
    for (const propagation::PairMetrics& pair : pairs) {
        lines.add_record(pair_head(header.scene, pair.source, pair.listener, pair.time) + "," +
                         json_text(to_json(pair)).substr(1));
    }
    lines.end_list();
    return lines.finish();
}

namespace {

Json noise_column(const std::vector<audio::BandNoise>& noise,
                  std::optional<double> audio::BandNoise::*value) {
    Json column = Json::array();
    for (const audio::BandNoise& band : noise) {
        column.push_back(to_json(band.*value));
    }
    return column;
}

Json to_json(const ChannelMetrics& channel) {
    Json json = {{"channel", channel.channel}, {"onset", to_json(channel.onset)}};
    json.update(to_json(channel.metrics));
    json["single"]["bass_ratio"] = to_json(channel.bass_ratio);
    if (!channel.metrics.noise.empty()) {
        json["noise_level"] = noise_column(channel.metrics.noise, &audio::BandNoise::level_db);
        json["peak_to_noise"] =
            noise_column(channel.metrics.noise, &audio::BandNoise::peak_to_noise_db);
    }
    json["notes"] = to_json(channel.metrics.notes);
    if (const auto& support = channel.support) {
        json["st_early"] = to_json(support->early_db);
        json["st_late"] = to_json(support->late_db);
        json["single"]["st_early_mean"] = to_json(support->early_mean_db);
        json["single"]["st_late_mean"] = to_json(support->late_mean_db);
        for (const Json& note : to_json(support->notes)) {
            json["notes"].push_back(note);
        }
    }
    return json;
}

/// What concerns a file and all of its channels.
Json head_of(const SoundMetrics& sound) {
    Json head = {{"file", sound.file}, {"sample_rate", sound.sample_rate}};
    add_speech(sound.speech, head);
    add_spatial(sound.lateral, sound.binaural, head);
    if (const auto& late = sound.late_lateral) {
        head["lj"] = to_json(late->level_db);
        head["lj_mean"] = to_json(late->mean_db);
        for (const Json& note : to_json(late->notes)) {
            head["notes"].push_back(note);
        }
    }
    return head;
}

void add_channels(const SoundMetrics& sound, std::size_t indent, JsonLines& lines) {
    lines.begin_list("\n\"channels\":", indent);
    for (const ChannelMetrics& channel : sound.channels) {
        lines.add_record(json_text(to_json(channel)));
    }
    lines.end_list();
}

}  // namespace

std::string encode_sound_metrics(const audio::Bands& bands, std::span<const SoundMetrics> files) {
    EARSHOT_ASSERT(!files.empty());
    Json head = {{"version", 2}};
    JsonLines lines;
    if (files.size() == 1) {
        head.update(head_of(files.front()));
    }
    head["bands_hz"] = to_json(bands.nominal_hz());
    if (files.size() == 1) {
        lines.append("{" + members(head));
        add_channels(files.front(), 1, lines);
        return lines.finish();
    }
    lines.begin_list("{" + members(head) + "\n\"files\":", 1);
    for (const SoundMetrics& sound : files) {
        lines.begin_record();
        lines.append("{" + members(head_of(sound)));
        add_channels(sound, 2, lines);
        lines.append("}");
    }
    lines.end_list();
    return lines.finish();
}

}  // namespace earshot::io
