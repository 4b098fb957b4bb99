// SPDX-License-Identifier: MIT
#include "earshot/cli/simplify_report.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <cmath>

namespace earshot::cli {
namespace {

using namespace propagation;

constexpr std::size_t kMaxRows = 12;
constexpr std::size_t kBand500 = 4;  // of the octaves from 31.5 Hz
constexpr std::size_t kBand1000 = 5;

std::string row(const char* name, const std::string& value) {
    return formatted("%-13s", name) + value + "\n";
}

std::string millimetres(double metres) {
    return short_text(1000.0 * metres) + " mm";
}

double mid(const audio::Spectrum& values) {
    return 0.5 * (values[kBand500] + values[kBand1000]);
}

std::string change_text(const SurfaceChange& change) {
    return "at most " + millimetres(change.upper()) + " (original to copy " +
           millimetres(change.to_simplified.upper) + ", copy to original " +
           millimetres(change.to_original.upper) + ")";
}

std::string geometry_text(const SimplificationReport& report) {
    std::string text = row("triangles",
                           std::to_string(report.triangles_before) + " -> " +
                               std::to_string(report.triangles_after) + " in " +
                               std::to_string(report.parts) + " connected parts");
    if (report.objects.size() < report.parts) {
        text += row("distance", change_text(report.surfaces));
    }
    if (!report.objects.empty()) {
        text += row("boxes",
                    "for " + std::to_string(report.objects.size()) + " objects, " +
                        change_text(report.boxes));
    }
    if (report.dropped_triangles > 0) {
        text +=
            row("dropped",
                std::to_string(report.dropped_triangles) + " triangles without an area or doubled");
    }
    if (report.parts_tightened + report.parts_kept > 0) {
        text +=
            row("measured",
                std::to_string(report.parts_tightened) + " parts simplified again more closely, " +
                    std::to_string(report.parts_kept) + " left as they were");
    }
    text += row("volume",
                "of closed solids " + short_text(report.solid_volume_before) + " -> " +
                    short_text(report.solid_volume_after) + " m3");
    text += row("absorption",
                "area at 500 Hz and 1 kHz " + short_text(mid(report.absorption_area_before)) +
                    " -> " + short_text(mid(report.absorption_area_after)) + " m2");
    return text;
}

std::string materials_text(const SimplifiedModel& model) {
    const std::vector<MaterialChange>& changes = model.report.materials;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        if (changes[i].triangles_before > 0) {
            order.push_back(i);
        }
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return changes[a].triangles_before > changes[b].triangles_before;
    });
    std::string text =
        "\nmaterial                           triangles          area m2   absorbs m2   data\n";
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == kMaxRows) {
            text += "and " + std::to_string(order.size() - kMaxRows) + " more\n";
            break;
        }
        const MaterialChange& change = changes[order[i]];
        std::string name = on_one_line(model.scene.materials[order[i]].name);
        name.resize(std::max<std::size_t>(26, name.size()), ' ');
        text += name +
                formatted(" %8zu -> %6zu %7s -> %6s",
                          change.triangles_before,
                          change.triangles_after,
                          short_text(change.area_before).c_str(),
                          short_text(change.area_after).c_str()) +
                formatted(" %5s -> %5s   ",
                          short_text(mid(change.absorption_area_before)).c_str(),
                          short_text(mid(change.absorption_area_after)).c_str()) +
                (change.is_limited     ? "absorbs all"
                 : change.has_new_data ? "adjusted"
                                       : "same");
        if (change.has_new_data && change.removed_depth > 0.0) {
            text += ", scatters as " + millimetres(change.removed_depth) + " deep";
        }
        text += "\n";
    }
    return text;
}

std::string close_emitters_text(const SimplifiedModel& model) {
    std::string text;
    for (const CloseEmitter& close : model.report.close_emitters) {
        const Emitter& emitter =
            (close.is_source ? model.scene.sources : model.scene.listeners)[close.index];
        text += std::string(close.is_source ? "source \"" : "listener \"") +
                on_one_line(emitter.name) + "\" is " + millimetres(close.distance) +
                " from a surface: it may be on the other side now\n";
    }
    return text.empty() ? "" : "\n" + text;
}

std::string metric_text(const PairComparison& pair, const char* key, int digits) {
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        if (kind.key != key) {
            continue;
        }
        const auto before = pair.before.*kind.value;
        const auto after = pair.after.*kind.value;
        const auto difference = noticeable_difference(kind, pair.before, pair.after);
        const auto number = [&](const std::optional<double>& value) {
            return value ? formatted("%6.*f", digits, *value) : std::string("     -");
        };
        return number(before) + " -> " + number(after) +
               (difference ? formatted(" (%+.1f)", *difference) : std::string("       "));
    }
    return "";
}

std::string comparison_text(const SimplifiedModel& model, const ModelComparison& comparison) {
    std::string text =
        "\npair                              paths          T30 s (JND)              C80 dB "
        "(JND)\n";
    for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
        if (i == kMaxRows) {
            text += "and " + std::to_string(comparison.pairs.size() - kMaxRows) + " more\n";
            break;
        }
        const PairComparison& pair = comparison.pairs[i];
        std::string name = on_one_line(model.scene.sources[pair.source].name + " > " +
                                       model.scene.listeners[pair.listener].name);
        name.resize(std::max<std::size_t>(26, name.size()), ' ');
        text += name + formatted(" %7zu -> %6zu  ", pair.paths_before, pair.paths_after) +
                metric_text(pair, "t30", 2) + "  " + metric_text(pair, "c80", 1) + "\n";
    }
    const auto ratio = [](double before, double after) {
        return after > 0.0 ? short_text(before / after) : std::string("-");
    };
    return text + "\n" +
           row("paths",
               short_text(comparison.path_seconds_before) + " -> " +
                   short_text(comparison.path_seconds_after) + " s, " +
                   ratio(comparison.path_seconds_before, comparison.path_seconds_after) +
                   " times less") +
           row("with rays",
               short_text(comparison.seconds_before) + " -> " +
                   short_text(comparison.seconds_after) + " s, " +
                   ratio(comparison.seconds_before, comparison.seconds_after) + " times less");
}

}  // namespace

std::string simplify_text(const io::SimplificationReportParts& parts) {
    std::string text = on_one_line(parts.model.scene.name) + ": within " +
                       millimetres(parts.options.max_distance) + "\n\n";
    text += geometry_text(parts.model.report);
    text += row("took", short_text(parts.seconds) + " s");
    text += materials_text(parts.model) + close_emitters_text(parts.model);
    if (parts.comparison != nullptr) {
        text += comparison_text(parts.model, *parts.comparison);
    }
    return text;
}

}  // namespace earshot::cli
