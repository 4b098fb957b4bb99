// SPDX-License-Identifier: MIT
#include "earshot/cli/response_summary.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/cli/pair_metrics_table.h"
#include "earshot/cli/sensitivity_table.h"
#include "earshot/cli/update_summary.h"
#include "earshot/propagation/plausibility.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string seconds_text(double seconds) {
    return formatted("%.3f s", seconds);
}

std::string names_of(const std::vector<propagation::Emitter>& emitters) {
    constexpr std::size_t kMaxNames = 8;
    std::string text = std::to_string(emitters.size());
    for (std::size_t i = 0; i < emitters.size() && i < kMaxNames; ++i) {
        text += (i == 0 ? " (" : ", ") + on_one_line(emitters[i].name);
    }
    return text + (emitters.size() > kMaxNames ? ", ...)" : ")");
}

/// The clean-up counts under the names that a reader sees, in order.
std::vector<std::pair<const char*, std::size_t>> clean_counts(const geometry::CleanReport& clean) {
    return {{"welded vertices", clean.vertices_welded},
            {"degenerate triangles", clean.degenerate_triangles},
            {"duplicate triangles", clean.duplicate_triangles},
            {"open edges", clean.open_edges},
            {"holes", clean.holes},
            {"non-manifold edges", clean.non_manifold_edges},
            {"T-junctions", clean.t_junctions}};
}

/// Rays measure the volume; without them it is not known.
std::string volume_text(double volume) {
    return volume > 0.0 ? "air in sight of the sources " + propagation::short_text(volume) + " m3"
                        : "volume not measured (no rays)";
}

Json volume_json(double volume) {
    return volume > 0.0 ? Json(volume) : Json(nullptr);
}

std::string clean_text(const geometry::CleanReport& clean) {
    std::string text;
    for (const auto& [name, count] : clean_counts(clean)) {
        if (count > 0) {
            text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
        }
    }
    return text.empty() ? "nothing to repair" : text;
}

std::string line(const char* label, const std::string& value) {
    return formatted("%-11s", label) + value + "\n";
}

/// Precondition: there is one.
std::string updates_text(std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    return std::to_string(seconds.size()) + ", of " + seconds_text(seconds.front()) + " to " +
           seconds_text(seconds.back()) + ", median " + seconds_text(seconds[seconds.size() / 2]);
}

}  // namespace

std::string summary_text(const ResponseJob& job, const ResponseSummary& summary) {
    const auto& geometry = summary.geometry;
    std::string text;
    text += line("scene",
                 on_one_line(job.scene.name) + ": " + std::to_string(geometry.triangles) +
                     " triangles, " + std::to_string(geometry.facets) + " facets, " +
                     std::to_string(job.scene.materials.size()) + " materials");
    text += line("extent",
                 propagation::size_text(summary.size) + ", " + volume_text(summary.visible_volume));
    text += line("clean-up", clean_text(geometry.clean));
    text += line("sources", names_of(job.scene.sources));
    text += line("listeners", names_of(job.scene.listeners));
    std::size_t all = 0;
    std::string orders;
    for (std::size_t order = 0; order < summary.paths_of_order.size(); ++order) {
        all += summary.paths_of_order[order];
        orders += (order == 0 ? "" : ", ") + std::string("order ") + std::to_string(order) + ": " +
                  std::to_string(summary.paths_of_order[order]);
    }
    text += line("paths", std::to_string(all) + " (" + orders + ")");
    if (job.simulation.visible_sets != nullptr) {
        text += line("visibility",
                     job.check_visibility
                         ? std::to_string(summary.paths_lost) + " paths lost to visible sets"
                         : "not checked; --check-visibility counts the paths that sets cost");
    }
    text += line("frusta",
                 std::to_string(summary.statistics.frusta) + " traced, " +
                     std::to_string(summary.statistics.candidates) + " sequences verified");
    if (job.is_sequence) {
        text += line("kept",
                     std::to_string(summary.statistics.kept_frusta) + " frusta, " +
                         std::to_string(summary.statistics.kept_candidates) + " sequences");
    }
    text += line("time",
                 "prepare " + seconds_text(summary.prepare_seconds) + ", trace " +
                     seconds_text(summary.trace_seconds) + ", responses " +
                     seconds_text(summary.response_seconds));
    if (job.is_sequence) {
        text += line("updates", updates_text(summary.update_seconds));
    }
    text += "files\n";
    for (const std::filesystem::path& file : summary.files) {
        text += "  " + file.string() + "\n";
    }
    return text + pair_metrics_text(job, summary) + sensitivity_text(job, summary);
}

std::string summary_json(const ResponseJob& job, const ResponseSummary& summary) {
    const auto& geometry = summary.geometry;
    Json clean = {{"triangles_read", geometry.clean.triangles_read},
                  {"vertices_read", geometry.clean.vertices_read}};
    for (auto [name, count] : clean_counts(geometry.clean)) {
        std::string key = name;
        for (char& c : key) {
            c = c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(c));
        }
        clean[key] = count;
    }
    std::vector<std::string> files;
    for (const std::filesystem::path& file : summary.files) {
        files.push_back(file.string());
    }
    Json notes = Json::array();
    for (const Warning& note : summary.notes) {
        notes.push_back({{"subject", note.subject}, {"text", note.what}});
    }
    Json json = {{"version", 1},
                 {"scene", job.scene.name},
                 {"triangles", geometry.triangles},
                 {"facets", geometry.facets},
                 {"extent", {summary.size.x, summary.size.y, summary.size.z}},
                 {"height", summary.size.y},
                 {"volume", volume_json(summary.visible_volume)},
                 {"clean_up", std::move(clean)},
                 {"sources", job.scene.sources.size()},
                 {"listeners", job.scene.listeners.size()},
                 {"times", job.times},
                 {"paths_per_order", summary.paths_of_order},
                 {"frusta", summary.statistics.frusta},
                 {"candidates", summary.statistics.candidates},
                 {"kept_frusta", summary.statistics.kept_frusta},
                 {"kept_candidates", summary.statistics.kept_candidates},
                 {"hierarchy", update_json(summary.hierarchies.updates)},
                 {"seconds",
                  {{"prepare", summary.prepare_seconds},
                   {"trace", summary.trace_seconds},
                   {"responses", summary.response_seconds},
                   {"updates", summary.update_seconds}}},
                 {"files", std::move(files)},
                 {"notes", std::move(notes)}};
    if (job.check_visibility) {
        json["paths_lost_to_visible_sets"] = summary.paths_lost;
    }
    json["hierarchy"]["builds"] =
        summary.hierarchies.triangle_builds + summary.hierarchies.facet_builds;
    json.update(pair_metrics_json(job, summary));
    json.update(sensitivity_json(job, summary));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace earshot::cli
