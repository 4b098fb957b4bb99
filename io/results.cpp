// SPDX-License-Identifier: MIT
#include "earshot/io/results.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/wav.h"

#include <optional>
#include <span>
#include <string_view>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;  // keys in the order of the contract

Json to_json(const geometry::Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json to_json(const audio::Spectrum& spectrum, std::size_t count) {
    return Json(std::vector<double>(spectrum.begin(), spectrum.begin() + static_cast<long>(count)));
}

Json to_json(std::span<const double> values) {
    return Json(std::vector<double>(values.begin(), values.end()));
}

Json to_json(const propagation::Path& path, const ResultHeader& header) {
    Json points = Json::array();
    for (const geometry::Vec3& point : path.points) {
        points.push_back(to_json(point));
    }
    Json materials = Json::array();
    for (const std::uint32_t material : path.materials) {
        materials.push_back(header.scene.materials[material].name);
    }
    return {{"kind", propagation::name_of(path.kind)},
            {"order", path.order},
            {"length", path.length},
            {"delay", path.delay},
            {"points", std::move(points)},
            {"triangles", path.triangles},
            {"materials", std::move(materials)},
            {"pressure", to_json(path.pressure, header.bands.count())},
            {"departure", to_json(path.departure)},
            {"arrival", to_json(path.arrival)}};
}

/// `{"source": "s", "listener": "l", "time": 0.0` without the closing brace.
std::string pair_head(const ResultHeader& header,
                      std::size_t source,
                      std::size_t listener,
                      double time) {
    return "{\"source\":" + json_text(header.scene.sources[source].name) +
           ",\"listener\":" + json_text(header.scene.listeners[listener].name) +
           ",\"time\":" + json_text(time);
}

Json column(const std::vector<audio::BandMetrics>& bands,
            std::optional<double> audio::BandMetrics::*value) {
    Json values = Json::array();
    for (const audio::BandMetrics& band : bands) {
        values.push_back(band.*value ? Json(*(band.*value)) : Json(nullptr));
    }
    return values;
}

}  // namespace

std::string encode_paths(const ResultHeader& header,
                         const std::vector<propagation::PairResult>& pairs) {
    JsonLines lines;
    lines.begin_list("{\"version\":1,\"scene\":" + json_text(header.scene.name) +
                         ",\"speed_of_sound\":" + json_text(header.speed_of_sound) +
                         ",\"bands_hz\":" + json_text(to_json(header.bands.nominal_hz())) +
                         ",\n\"pairs\":",
                     1);
    for (const propagation::PairResult& pair : pairs) {
        lines.add_record(pair_head(header, pair.source, pair.listener, pair.time));
        lines.begin_list(",\"paths\":", 2);
        for (const propagation::Path& path : pair.paths) {
            lines.add_record(json_text(to_json(path, header)));
        }
        lines.end_list();
        lines.append("}");
    }
    lines.end_list();
    return lines.finish();
}

namespace {

/// A list with a line per band.
void add_bands(std::string_view opening,
               const std::vector<audio::Spectrum>& intervals,
               std::size_t bands,
               JsonLines& lines) {
    lines.begin_list(opening, 2);
    for (std::size_t band = 0; band < bands; ++band) {
        Json values = Json::array();
        for (const audio::Spectrum& interval : intervals) {
            values.push_back(interval[band]);
        }
        lines.add_record(json_text(values));
    }
    lines.end_list();
}

/// The beginning of a document of pairs; leaves the list of pairs open.
void begin_pairs(const ResultHeader& header, JsonLines& lines) {
    lines.begin_list("{\"version\":1,\"bands_hz\":" +
                         json_text(to_json(header.bands.nominal_hz())) + ",\n\"pairs\":",
                     1);
}

}  // namespace

std::string encode_histograms(const ResultHeader& header,
                              const std::vector<propagation::PairResult>& pairs) {
    JsonLines lines;
    begin_pairs(header, lines);
    for (const propagation::PairResult& pair : pairs) {
        const std::size_t bands = header.bands.count();
        lines.add_record(pair_head(header, pair.source, pair.listener, pair.time) +
                         ",\"bin\":" + json_text(pair.late.bin));
        add_bands(",\n \"energy\":", pair.late.energy, bands, lines);
        add_bands(",\n \"error\":", pair.late.error, bands, lines);
        lines.append("}");
    }
    lines.end_list();
    return lines.finish();
}

namespace {

Json to_json(const std::vector<std::optional<double>>& values) {
    Json json = Json::array();
    for (const auto& value : values) {
        json.push_back(value ? Json(*value) : Json(nullptr));
    }
    return json;
}

Json to_json(const audio::RoomMetrics& metrics) {
    using Band = audio::BandMetrics;
    const auto& sti = metrics.speech_transmission_index;
    return {{"edt", column(metrics.bands, &Band::early_decay_time)},
            {"t20", column(metrics.bands, &Band::reverberation_time_t20)},
            {"t30", column(metrics.bands, &Band::reverberation_time_t30)},
            {"c50", column(metrics.bands, &Band::clarity_c50_db)},
            {"c80", column(metrics.bands, &Band::clarity_c80_db)},
            {"d50", column(metrics.bands, &Band::definition_d50)},
            {"ts", column(metrics.bands, &Band::centre_time)},
            {"g", column(metrics.bands, &Band::strength_db)},
            {"sti", sti ? Json(*sti) : Json(nullptr)},
            {"notes", metrics.notes}};
}

/// Metrics of several channels; their notes join the others.
void add_spatial(const std::optional<audio::LateralMetrics>& lateral,
                 const std::optional<audio::BinauralMetrics>& binaural,
                 Json& json) {
    const auto add_notes = [&](const std::vector<std::string>& notes) {
        for (const std::string& note : notes) {
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

}  // namespace

std::string encode_metrics(const ResultHeader& header,
                           const std::vector<propagation::PairMetrics>& pairs) {
    JsonLines lines;
    begin_pairs(header, lines);
    for (const propagation::PairMetrics& pair : pairs) {
        Json json = to_json(pair.metrics);
        json["schroeder_hz"] = pair.schroeder_hz ? Json(*pair.schroeder_hz) : Json(nullptr);
        add_spatial(pair.lateral, pair.binaural, json);
        json["energy"] = to_json(pair.energy);
        lines.add_record(pair_head(header, pair.source, pair.listener, pair.time) + "," +
                         json_text(json).substr(1));
    }
    lines.end_list();
    return lines.finish();
}

std::string encode_sound_metrics(const std::string& file,
                                 double sample_rate,
                                 const audio::Bands& bands,
                                 const SoundMetrics& metrics) {
    Json together = Json::object();
    add_spatial(metrics.lateral, metrics.binaural, together);
    std::string more;
    if (!together.empty()) {
        const std::string text = json_text(together);
        more = text.substr(1, text.size() - 2) + ",";
    }
    JsonLines lines;
    lines.begin_list("{\"version\":1,\"file\":" + json_text(file) +
                         ",\"sample_rate\":" + json_text(sample_rate) + ",\"bands_hz\":" +
                         json_text(to_json(bands.nominal_hz())) + "," + more + "\n\"channels\":",
                     1);
    for (std::size_t i = 0; i < metrics.channels.size(); ++i) {
        lines.add_record("{\"channel\":" + std::to_string(i + 1) + "," +
                         json_text(to_json(metrics.channels[i])).substr(1));
    }
    lines.end_list();
    return lines.finish();
}

std::string encode_response(const std::vector<audio::ImpulseResponse>& channels) {
    Sound sound = {.sample_rate = channels.front().sample_rate,
                   .channels = static_cast<int>(channels.size()),
                   .samples = {}};
    const std::size_t frames = channels.front().samples.size();
    sound.samples.reserve(frames * channels.size());
    for (std::size_t n = 0; n < frames; ++n) {
        for (const audio::ImpulseResponse& channel : channels) {
            sound.samples.push_back(channel.samples[n]);
        }
    }
    return encode_wav(sound);
}

}  // namespace earshot::io
