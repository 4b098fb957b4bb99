// SPDX-License-Identifier: MIT
#include "earshot/io/results.h"

#include "earshot/base/assert.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/pair_head.h"
#include "earshot/io/wav.h"

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
    Json json = {{"kind", propagation::name_of(path.kind)},
                 {"order", path.order},
                 {"length", path.length},
                 {"delay", path.delay},
                 {"points", std::move(points)}};
    if (path.kind == propagation::PathKind::diffracted) {
        Json edges = Json::array();
        for (const auto& [begin, end] : path.edges) {
            edges.push_back(Json::array({to_json(begin), to_json(end)}));
        }
        json["edges"] = std::move(edges);
    }
    json["triangles"] = path.triangles;
    json["materials"] = std::move(materials);
    json["pressure"] = to_json(path.pressure, header.bands.count());
    json["departure"] = to_json(path.departure);
    json["arrival"] = to_json(path.arrival);
    return json;
}

}  // namespace

std::string pair_head(const propagation::Scene& scene,
                      std::size_t source,
                      std::size_t listener,
                      double time) {
    return "{\"source\":" + json_text(scene.sources[source].name) +
           ",\"listener\":" + json_text(scene.listeners[listener].name) +
           ",\"time\":" + json_text(time);
}

std::string encode_paths(const ResultHeader& header,
                         const std::vector<propagation::PairResult>& pairs,
                         std::span<const propagation::Pose> listeners) {
    EARSHOT_ASSERT(listeners.empty() || listeners.size() == pairs.size());
    JsonLines lines;
    lines.begin_list("{\"version\":1,\"scene\":" + json_text(header.scene.name) +
                         ",\"speed_of_sound\":" + json_text(header.speed_of_sound) +
                         ",\"bands_hz\":" + json_text(to_json(header.bands.nominal_hz())) +
                         ",\n\"pairs\":",
                     1);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const propagation::PairResult& pair = pairs[i];
        lines.add_record(pair_head(header.scene, pair.source, pair.listener, pair.time));
        if (!listeners.empty()) {
            lines.append(",\"listener_front\":" + json_text(to_json(listeners[i].front)) +
                         ",\"listener_up\":" + json_text(to_json(listeners[i].up)));
        }
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

}  // namespace

std::string encode_histograms(const ResultHeader& header,
                              const std::vector<propagation::PairResult>& pairs) {
    JsonLines lines;
    lines.begin_list("{\"version\":1,\"bands_hz\":" +
                         json_text(to_json(header.bands.nominal_hz())) + ",\n\"pairs\":",
                     1);
    for (const propagation::PairResult& pair : pairs) {
        const std::size_t bands = header.bands.count();
        lines.add_record(pair_head(header.scene, pair.source, pair.listener, pair.time) +
                         ",\"bin\":" + json_text(pair.late.bin));
        add_bands(",\n \"energy\":", pair.late.energy, bands, lines);
        add_bands(",\n \"error\":", pair.late.error, bands, lines);
        lines.append("}");
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
