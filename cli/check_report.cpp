// SPDX-License-Identifier: MIT
#include "earshot/cli/check_report.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>

namespace earshot::cli {
namespace {

using namespace propagation;

/// The verdict and these lines fit on the first ten.
constexpr std::size_t kMaxFindings = 8;
constexpr std::size_t kMaxRows = 12;

std::string place_text(const geometry::Vec3& at) {
    return short_text(at.x) + ", " + short_text(at.y) + ", " + short_text(at.z);
}

const char* word_of(Severity severity) {
    switch (severity) {
        case Severity::unusable:
            return "unusable";
        case Severity::questionable:
            return "questionable";
        case Severity::note:
            break;
    }
    return "note";
}

std::string findings_text(const io::ModelReportParts& parts, std::size_t first, std::size_t last) {
    std::string text;
    for (std::size_t i = first; i < std::min(last, parts.findings.size()); ++i) {
        text += formatted("  %-13s", word_of(parts.findings[i].severity)) +
                on_one_line(parts.findings[i].text) + "\n";
    }
    return text;
}

std::string row(const char* name, const std::string& value) {
    return formatted("%-11s", name) + value + "\n";
}

std::string airs_text(const io::ModelReportParts& parts) {
    std::string text;
    std::size_t number = 0;
    for (const SharedAir& air : parts.report.airs) {
        const std::string name =
            parts.report.airs.size() == 1 ? std::string("air") : "air " + std::to_string(++number);
        const std::string size = air.volume > 0.0 ? short_text(air.volume) + " m3, surface " +
                                                        short_text(air.surface) + " m2"
                                                  : "open";
        const std::string who = parts.report.probe
                                    ? "around " + place_text(*parts.report.probe)
                                    : std::to_string(air.sources.size()) + " sources, " +
                                          std::to_string(air.listeners.size()) + " listeners";
        text += row(name.c_str(), size + "; " + who);
    }
    return text;
}

const char* word_of(MaterialOrigin origin) {
    switch (origin) {
        case MaterialOrigin::none:
            return "none";
        case MaterialOrigin::by_name:
            return "by name";
        case MaterialOrigin::library:
            return "library";
        case MaterialOrigin::stated:
            break;
    }
    return "given";
}

std::string materials_text(const io::ModelReportParts& parts) {
    std::vector<std::size_t> order(parts.report.materials.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = i;
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return parts.report.materials[a].absorption_share >
               parts.report.materials[b].absorption_share;
    });
    std::string text = "\nmaterial                    area m2  absorbs  data\n";
    std::size_t rows = 0;
    for (const std::size_t i : order) {
        const MaterialUse& use = parts.report.materials[i];
        if (use.area == 0.0) {
            continue;
        }
        if (rows++ == kMaxRows) {
            text += "...\n";
            break;
        }
        std::string name = on_one_line(parts.scene.materials[i].name);
        name.resize(std::max<std::size_t>(26, name.size()), ' ');
        text +=
            name +
            formatted(" %8s %6.0f %%", short_text(use.area).c_str(), 100.0 * use.absorption_share) +
            "  " + word_of(use.origin);
        for (const std::string& doubt : use.doubts) {
            text += ", " + doubt;
        }
        text += "\n";
    }
    return rows == 0 ? "" : text;
}

/// Per octave the part of the surface that does not reflect like mirrors.
std::string small_facets_text(const ModelReport& report) {
    std::string octaves = "\noctave Hz  ";
    std::string lengths = "facets < m ";  // half a wavelength
    std::string shares = "their area ";
    for (const SmallFacets& small : report.small_facets) {
        octaves += formatted(" %7s", short_text(small.frequency_hz).c_str());
        lengths += formatted(" %7s", short_text(small.half_wavelength).c_str());
        shares += formatted(" %5.0f %%", 100.0 * small.area_share);
    }
    return octaves + "\n" + lengths + "\n" + shares + "\n";
}

std::string costs_text(const ModelReport& report) {
    if (report.costs.empty()) {
        return "";
    }
    std::string text = "\norder      ";
    std::string seconds = "seconds    ";
    for (const OrderCost& cost : report.costs) {
        text += formatted(" %9d", cost.order);
        seconds +=
            formatted(" %9s", ((cost.is_measured ? "" : "~") + short_text(cost.seconds)).c_str());
    }
    return text + "\n" + seconds + "\n";
}

/// Triangle numbers, runs as first-last; of many runs the first ones.
std::string ranges(const std::vector<geometry::TriangleId>& ascending) {
    constexpr int kMaxRuns = 100;
    std::string text;
    int runs = 0;
    for (std::size_t i = 0; i < ascending.size();) {
        if (runs++ == kMaxRuns) {
            return text + ", ... (all with --json)";
        }
        std::size_t last = i;
        while (last + 1 < ascending.size() && ascending[last + 1] == ascending[last] + 1) {
            ++last;
        }
        text += (text.empty() ? "" : ", ") + std::to_string(ascending[i]) +
                (last > i ? "-" + std::to_string(ascending[last]) : "");
        i = last + 1;
    }
    return text;
}

std::string mending_text(const MendingReport& mending) {
    std::string text = "\nmended\n";
    const auto add = [&](const char* what, const std::vector<geometry::TriangleId>& triangles) {
        if (!triangles.empty()) {
            text += "  " + std::to_string(triangles.size()) + what + ranges(triangles) + "\n";
        }
    };
    if (mending.welded_vertices > 0) {
        text += "  " + std::to_string(mending.welded_vertices) + " vertices welded\n";
    }
    add(" removed without an area: triangles ", mending.degenerate);
    add(" removed as doubled: triangles ", mending.doubled);
    add(" removed, proved out of reach: triangles ", mending.unreached);
    add(" turned to the air: triangles ", mending.turned);
    add(" kept, not reached by rays but not proved out of reach: triangles ", mending.doubtful);
    for (const MendingReport::FilledHole& hole : mending.filled) {
        text += "  hole " + std::to_string(hole.hole) + " filled with " +
                std::to_string(hole.triangles) + " triangles\n";
    }
    return text + "  coordinates rounded by up to " + short_text(mending.max_rounding) + " m\n";
}

}  // namespace

std::string check_text(const io::ModelReportParts& parts) {
    const ModelReport& report = parts.report;
    const Severity severity = gravest(parts.findings);
    const auto faults = static_cast<std::size_t>(
        std::count_if(parts.findings.begin(), parts.findings.end(), [](const Finding& finding) {
            return finding.severity != Severity::note;
        }));
    std::string text =
        on_one_line(parts.scene.name) + ": " +
        (severity == Severity::note ? "clean" : word_of(severity)) +
        (faults > 0 ? ", " + std::to_string(faults) + (faults == 1 ? " finding" : " findings")
                    : "") +
        "\n";
    text += findings_text(parts, 0, kMaxFindings);
    if (parts.findings.size() > kMaxFindings) {
        text += "  and " + std::to_string(parts.findings.size() - kMaxFindings) + " more, below\n";
    }
    text += "\n" + row("extent", size_text(report.extent.size())) + airs_text(parts);
    std::size_t closed = 0;
    for (const geometry::Island& island : report.topology.islands) {
        closed += island.is_closed ? 1 : 0;
    }
    text += row("triangles",
                std::to_string(report.topology.clean.kept.size()) + " in " +
                    std::to_string(report.topology.islands.size()) + " connected parts, " +
                    std::to_string(closed) + " of them closed");
    text += row("reached",
                std::to_string(report.topology.clean.kept.size() - report.unreached.size()) +
                    " triangles by " + std::to_string(report.rays) + " rays");
    text += materials_text(parts) + small_facets_text(report) + costs_text(report);
    if (parts.findings.size() > kMaxFindings) {
        text += "\nmore findings\n" + findings_text(parts, kMaxFindings, parts.findings.size());
    }
    if (parts.mending != nullptr) {
        text += mending_text(*parts.mending);
    }
    return text;
}

int check_status(Severity severity) {
    constexpr int kClean = 0;
    constexpr int kUnusable = 1;
    constexpr int kQuestionable = 3;
    return severity == Severity::unusable       ? kUnusable
           : severity == Severity::questionable ? kQuestionable
                                                : kClean;
}

}  // namespace earshot::cli
