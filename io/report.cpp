// SPDX-License-Identifier: MIT
#include "earshot/io/report.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/report_blocks.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <map>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;

/// The sources or listeners of the pairs, numbered in the order of their first pair.
class EmitterList {
public:
    std::size_t add(const std::string& name, const std::optional<geometry::Vec3>& position) {
        const auto [known, is_new] = number_.try_emplace(name, emitters_.size());
        if (is_new) {
            emitters_.push_back({name, position});
        } else if (!emitters_[known->second].position) {
            emitters_[known->second].position = position;
        }
        return known->second;
    }

    /// Of those that no path tells the position of, the scene does.
    Json json(const propagation::Scene* scene,
              std::vector<propagation::Emitter> propagation::Scene::*of,
              double time) const {
        Json list = Json::array();
        for (const Entry& entry : emitters_) {
            std::optional<geometry::Vec3> position = entry.position;
            if (!position && scene != nullptr) {
                const auto& known = scene->*of;
                const auto emitter =
                    std::find_if(known.begin(), known.end(), [&](const propagation::Emitter& e) {
                        return e.name == entry.name;
                    });
                if (emitter != known.end()) {
                    position = scene->position_at(*emitter, time);
                }
            }
            list.push_back(
                {{"name", entry.name},
                 {"position",
                  position ? Json({position->x, position->y, position->z}) : Json(nullptr)}});
        }
        return list;
    }

private:
    struct Entry {
        std::string name;
        std::optional<geometry::Vec3> position;
    };
    std::vector<Entry> emitters_;
    std::map<std::string, std::size_t> number_;
};

Json room_block(const RoomReport& report, const ResultFiles& results) {
    Json room = Json::object();
    if (report.scene != nullptr) {
        const geometry::Vec3 size = propagation::scene_extent(*report.scene, report.time).size();
        room["extent"] = {size.x, size.y, size.z};
    }
    if (results.room.is_object()) {
        room.update(results.room);
    }
    return room;
}

/// Curves of many pairs are shown with fewer points, so that all have about as many together.
PairDetail detail_of(const RoomReport& report, const ResultFiles& results) {
    constexpr std::size_t kMaxPoints = 400;
    constexpr std::size_t kMinPoints = 40;
    constexpr std::size_t kMaxPointsOfAll = 300000;
    const std::size_t curves =
        std::max<std::size_t>(1, results.pairs.size() * results.bands.count());
    return {.decays = !report.paths.text.empty() && !report.histograms.text.empty(),
            .max_points = std::clamp(kMaxPointsOfAll / curves, kMinPoints, kMaxPoints)};
}

void warn_of_missing(const RoomReport& report, Warnings& warnings) {
    if (report.histograms.text.empty() && !report.paths.text.empty()) {
        warnings.push_back({"histograms.json",
                            "is missing, and with it decay curves and late energy; earshot ir "
                            "--histograms writes it"});
    }
}

/// Members of the document on lines of their own.
class Document {
public:
    void add_text(std::string_view key, const std::string& text) {
        text_ += (text_.empty() ? "{\"" : ",\n\"") + std::string(key) + "\":" + text;
    }
    void add(std::string_view key, const Json& value) { add_text(key, json_text(value)); }

    std::string finish() && { return std::move(text_) + "}\n"; }

private:
    std::string text_;
};

}  // namespace

Json warnings_block(const Warnings& warnings) {
    Json list = Json::array();
    for (const Warning& warning : warnings) {
        list.push_back(warning.subject + ": " + warning.what);
    }
    return list;
}

Json provenance_block(const ReportProvenance& provenance, const std::string& digest) {
    return {{"program", "earshot"},
            {"version", provenance.version},
            {"command", provenance.command},
            {"seed", provenance.seed ? Json(*provenance.seed) : Json(nullptr)},
            {"scene_digest", digest.empty() ? Json(nullptr) : Json(digest)},
            {"files", provenance.files}};
}

std::string encode_room_report(const RoomReport& report) {
    ResultFiles results = read_result_files(report);
    if (report.scene != nullptr && results.materials.is_array() &&
        results.materials.size() != report.scene->materials.size()) {
        refuse_result_file(report.sensitivity, "has other materials than the scene");
    }
    Warnings warnings = report.warnings;
    warn_of_missing(report, warnings);
    if (results.pairs.size() > kMaxReportPairs) {
        warnings.push_back({report.title,
                            "the page shows the first " + std::to_string(kMaxReportPairs) + " of " +
                                std::to_string(results.pairs.size()) +
                                " pairs of source and listener"});
    }
    Document document;
    document.add("format", Json(1));
    document.add("kind", Json("rooms"));
    document.add("title", Json(report.title));
    document.add(
        "provenance",
        provenance_block(report.provenance,
                         report.scene == nullptr ? "" : scene_digest(*report.scene, report.time)));
    document.add("verdict", verdict_block(report, results));
    document.add("room", room_block(report, results));
    document.add("bands",
                 Json(std::vector<double>(results.bands.nominal_hz().begin(),
                                          results.bands.nominal_hz().end())));
    if (report.scene != nullptr) {
        document.add("scene", scene_block(*report.scene, report.time, warnings));
        document.add(
            "materials",
            materials_block(*report.scene, report.time, report.default_materials, results.bands));
    } else if (results.materials.is_array()) {
        document.add("materials", results.materials);
    }
    results.pairs.resize(std::min(results.pairs.size(), kMaxReportPairs));
    const PairDetail detail = detail_of(report, results);
    EmitterList sources;
    EmitterList listeners;
    std::string pairs;
    std::vector<std::size_t> source_of;
    std::vector<std::size_t> listener_of;
    for (const ResultPair& pair : results.pairs) {
        source_of.push_back(sources.add(pair.source, pair.source_position));
        listener_of.push_back(listeners.add(pair.listener, pair.listener_position));
        std::optional<ReportAudio> audio;
        if (report.audio_of && source_of.size() <= kMaxReportSounds) {
            audio = report.audio_of(pair.source, pair.listener, pair.time);
        }
        pairs +=
            (pairs.empty() ? "\n" : ",\n") +
            pair_block(pair, results.bands, source_of.back(), listener_of.back(), detail, audio);
    }
    document.add("sources", sources.json(report.scene, &propagation::Scene::sources, report.time));
    document.add("listeners",
                 listeners.json(report.scene, &propagation::Scene::listeners, report.time));
    document.add_text("pairs", "[" + pairs + "]");
    if (results.materials.is_array()) {
        document.add("sensitivity", sensitivity_block(results, source_of, listener_of, warnings));
    }
    document.add("warnings", warnings_block(warnings));
    return std::move(document).finish();
}

}  // namespace earshot::io
