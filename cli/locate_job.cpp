// SPDX-License-Identifier: MIT
#include "earshot/cli/locate_job.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/io/arrivals.h"
#include "earshot/io/location.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using propagation::LocatedPoint;
using propagation::LocateResult;

constexpr std::size_t kMaxRows = 12;
constexpr const char* kGroup = "Locating";

std::string row(const char* name, const std::string& value) {
    return formatted("%-11s", name) + value + "\n";
}

double moved(const LocatedPoint& point) {
    const geometry::Vec3 move = point.position() - point.stated();
    return std::sqrt(move.x * move.x + move.y * move.y + move.z * move.z);
}

std::string moves_text(const char* what,
                       const std::vector<propagation::Emitter>& emitters,
                       const std::vector<LocatedPoint>& points) {
    if (points.empty()) {
        return "";
    }
    std::vector<std::optional<double>> moves;
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        moves.emplace_back(moved(points[i]));
        farthest = *moves[i] > *moves[farthest] ? i : farthest;
    }
    return row(what,
               formatted("moved by %.1f mm (median), at most %.1f mm: ",
                         1e3 * *propagation::median_absolute(moves),
                         1e3 * *moves[farthest]) +
                   on_one_line(emitters[farthest].name));
}

std::string points_text(const char* what,
                        const std::vector<propagation::Emitter>& emitters,
                        const std::vector<LocatedPoint>& points) {
    std::string text =
        formatted("\n%-16s %9s %9s %9s %8s %9s\n", what, "x m", "y m", "z m", "+- mm", "moved mm");
    for (std::size_t i = 0; i < std::min(points.size(), kMaxRows); ++i) {
        const LocatedPoint& point = points[i];
        std::string name = on_one_line(emitters[i].name);
        name.resize(std::max<std::size_t>(16, name.size()), ' ');
        text += name + formatted(" %9.4f %9.4f %9.4f %8.1f %9.1f\n",
                                 point.x.value,
                                 point.y.value,
                                 point.z.value,
                                 1e3 * std::max({point.x.standard_error,
                                                 point.y.standard_error,
                                                 point.z.standard_error}),
                                 1e3 * moved(point));
    }
    return text + (points.size() > kMaxRows ? "...\n" : "");
}

std::string latencies_text(const io::LocationParts& parts) {
    std::string text;
    for (std::size_t i = 0; i < parts.scene.sources.size(); ++i) {
        const propagation::LocatedValue& latency = parts.result.latencies[i];
        text +=
            row("latency",
                formatted("%.4f +- %.4f ms: ", 1e3 * latency.value, 1e3 * latency.standard_error) +
                    on_one_line(parts.scene.sources[i].name));
    }
    return text;
}

std::string walls_text(const io::LocationParts& parts) {
    std::string text;
    for (const propagation::LocatedWall& wall : parts.result.walls) {
        text += row("wall",
                    formatted("moved by %.1f +- %.1f mm along (%.3f, %.3f, %.3f): ",
                              1e3 * (wall.offset.value - wall.offset.stated),
                              1e3 * wall.offset.standard_error,
                              wall.normal.x,
                              wall.normal.y,
                              wall.normal.z) +
                        on_one_line(parts.scene.materials[wall.material].name));
    }
    return text;
}

std::string summary_text(const io::LocationParts& parts,
                         const propagation::LocateOptions& options) {
    const LocateResult& result = parts.result;
    std::string text =
        row("arrivals",
            std::to_string(result.matched) + " of " + std::to_string(parts.arrivals.size()) +
                " on paths of order up to " + std::to_string(result.specular_order));
    text += row("error",
                formatted("%.4f ms as stated, %.4f ms as located (median)",
                          1e3 * result.median_before,
                          1e3 * result.median_after));
    if (const auto held_out = propagation::median_absolute(parts.held_out)) {
        text += row("held out", formatted("%.4f ms (median)", 1e3 * *held_out));
    }
    text += row("speed",
                formatted("%.3f +- %.3f m/s, air of %.1f C; stated %.3f m/s, %.1f C",
                          result.speed_of_sound.value,
                          result.speed_of_sound.standard_error,
                          result.temperature_c,
                          result.speed_of_sound.stated,
                          options.air.temperature_c));
    text += moves_text("sources", parts.scene.sources, result.sources);
    text += moves_text("listeners", parts.scene.listeners, result.listeners);
    text += options.latency_error > 0.0 ? latencies_text(parts) : "";
    text += options.wall_error > 0.0 ? walls_text(parts) : "";
    text += points_text("source", parts.scene.sources, result.sources);
    return text + points_text("listener", parts.scene.listeners, result.listeners);
}

Warnings doubts_of(const std::string& file, const io::LocationParts& parts) {
    const LocateResult& result = parts.result;
    constexpr double kMaxMove = 2.0;  // stated errors
    Warnings warnings;
    if (result.matched < parts.arrivals.size()) {
        warnings.push_back({file,
                            std::to_string(parts.arrivals.size() - result.matched) +
                                " arrivals fit no path and are left out"});
    }
    std::string motions;
    for (const propagation::CommonMotion& motion : result.motions) {
        if (!motion.is_told_by_data()) {
            motions += (motions.empty() ? "" : ", ") + motion.name;
        }
    }
    if (!motions.empty()) {
        warnings.push_back(
            {file, "the arrivals do not tell common motions, which stay as stated: " + motions});
    }
    if (result.rms_move > kMaxMove) {
        warnings.push_back({file,
                            "positions move by " + propagation::short_text(result.rms_move) +
                                " times their stated errors: these are too small, or the model is "
                                "not the room"});
    }
    if (!result.converged) {
        warnings.push_back({file, "the positions had not come to rest when the rounds ended"});
    }
    return warnings;
}

}  // namespace

void LocateJob::add_to(CLI::App& app) {
    app.add_option("--locate",
                   file_,
                   "a table of measured arrivals: source, listener, surfaces, time (seconds)")
        ->type_name("FILE")
        ->group(kGroup);
    const auto add =
        [&](const char* name, double& target, Limits<double> limits, const char* description) {
            add_number(app, name, target, limits, description)->group(kGroup);
        };
    constexpr Limits<double> kMetres = {0.0, 1e3}, kKelvin = {0.0, 100.0}, kSeconds = {0.0, 1e3};
    constexpr Limits<double> kSecondsAboveZero = {1e-9, 1e3};
    add("--source-error",
        options_.source_error,
        kMetres,
        "standard deviation of a source's stated coordinates, metres; 0: they are held; default: "
        "0.01");
    add("--listener-error", options_.listener_error, kMetres, "and of a listener's; default: 0.01");
    add("--temperature-error",
        options_.temperature_error,
        kKelvin,
        "of the air's temperature, kelvin, for the speed of sound; default: 2");
    add("--latency-error",
        options_.latency_error,
        kSeconds,
        "how late sources may start, seconds; default: 0");
    add("--wall-error",
        options_.wall_error,
        kMetres,
        "of the planes of reflecting surfaces, metres; default: 0");
    add("--timing-error",
        options_.timing_error,
        kSecondsAboveZero,
        "of the times but for outliers, seconds; default: 4e-5");
    add("--match-window",
        options_.match_window,
        kSecondsAboveZero,
        "how far a path may be from an arrival without surfaces, seconds; default: 0.001");
    add_integer(app,
                "--folds",
                folds_,
                {0, 1000},
                "parts of a cross-validation, each predicted from the others; 0: none; default: 0")
        ->group(kGroup);
}

void LocateJob::run(const Setting& setting, Executor& executor) const {
    propagation::LocateOptions options = options_;
    options.air = setting.air;
    options.time = setting.time;
    if (setting.order >= 0) {
        options.specular_order = setting.order;
    }
    const io::ArrivalTable table = io::read_arrivals(file_, setting.scene);
    LocateResult result;
    std::vector<std::optional<double>> held_out;
    {
        ProgressBar progress(setting.quiet);
        result = propagation::locate(setting.scene, table.arrivals, options, executor, &progress);
        if (folds_ > 0) {
            held_out = propagation::cross_validate_locate(setting.scene,
                                                          table.arrivals,
                                                          static_cast<std::size_t>(folds_),
                                                          setting.seed,
                                                          options,
                                                          executor,
                                                          &progress);
        }
    }
    const io::LocationParts parts = {
        .scene = setting.scene, .arrivals = table.arrivals, .result = result, .held_out = held_out};
    const std::string json = io::encode_location(parts);
    io::write_whole_file(setting.output, json);
    if (!setting.quiet) {
        print_warnings(table.warnings);
        print_warnings(doubts_of(file_, parts));
    }
    if (setting.json) {
        write_output(json);
    } else if (!setting.quiet) {
        write_output(summary_text(parts, options));
    }
}

}  // namespace earshot::cli
