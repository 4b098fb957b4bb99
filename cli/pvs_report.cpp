// SPDX-License-Identifier: MIT
#include "earshot/cli/pvs_report.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>
#include <vector>

namespace earshot::cli {

using visibility::CellId;
using visibility::MissedShare;
using visibility::VisibleSets;

namespace {

constexpr std::size_t kMaxRows = 10;

std::vector<std::size_t> triangles_per_cell(const VisibleSets& sets) {
    std::vector<std::size_t> counts;
    for (const auto& set : sets.sets()) {
        std::size_t count = 0;
        for (const visibility::ObjectId object : set) {
            count += sets.objects().triangles_of(object).size();
        }
        counts.push_back(count);
    }
    return counts;
}

/// What the validation batch tells of the directions in which the sets miss the closest hit.
std::string missed_line(const std::optional<MissedShare>& validation) {
    if (!validation) {
        return "missed     not known, as no validation rays were cast\n";
    }
    return formatted(
        "missed     %.2g of all directions, at most %.2g (%.0f %% confidence; %llu of %llu rays)\n",
        validation->estimate(),
        validation->upper_bound(),
        100.0 * MissedShare::kConfidence,
        static_cast<unsigned long long>(validation->missed),
        static_cast<unsigned long long>(validation->rays));
}

std::string as_text(const VisibleSets& sets,
                    const std::string& file,
                    std::optional<double> seconds) {
    const auto& provenance = sets.provenance();
    const auto cells = static_cast<double>(sets.cells().size());
    const visibility::ViewRegion& region = sets.cells().region();
    std::string text =
        "scene      " + on_one_line(provenance.scene) + formatted(" at %g s\n", provenance.time);
    text += formatted("region     %g,%g,%g to %g,%g,%g m\n",
                      region.lower.x,
                      region.lower.y,
                      region.lower.z,
                      region.upper.x,
                      region.upper.y,
                      region.upper.z);
    text += formatted("cells      %zu of %zu parts\n", sets.cells().size(), sets.cells().leaves());
    text += formatted("objects    %zu of %zu triangles\n",
                      sets.objects().size(),
                      sets.objects().object_of_triangle().size());
    text += formatted("entries    %llu, %.1f per cell\n",
                      static_cast<unsigned long long>(sets.entries()),
                      static_cast<double>(sets.entries()) / cells);
    text += formatted("rays       %llu\n", static_cast<unsigned long long>(provenance.rays));
    text += missed_line(provenance.validation);
    if (seconds) {
        text += formatted("time       %.3f s\n", *seconds);
    }
    return text + "file       " + file + "\n";
}

}  // namespace

std::string pvs_summary(const VisibleSets& sets,
                        const std::string& file,
                        std::optional<double> seconds,
                        bool as_json) {
    if (!as_json) {
        return as_text(sets, file, seconds);
    }
    const auto& provenance = sets.provenance();
    nlohmann::ordered_json json = {{"version", 1},
                                   {"scene", provenance.scene},
                                   {"time", provenance.time},
                                   {"cells", sets.cells().size()},
                                   {"leaves", sets.cells().leaves()},
                                   {"objects", sets.objects().size()},
                                   {"triangles", sets.objects().object_of_triangle().size()},
                                   {"entries", sets.entries()},
                                   {"rays", provenance.rays},
                                   {"missed_share", nullptr},
                                   {"missed_share_upper", nullptr},
                                   {"confidence", MissedShare::kConfidence},
                                   {"validation_rays", 0},
                                   {"seed", provenance.seed},
                                   {"file", file}};
    if (provenance.validation) {
        json["missed_share"] = provenance.validation->estimate();
        json["missed_share_upper"] = provenance.validation->upper_bound();
        json["validation_rays"] = provenance.validation->rays;
    }
    if (seconds) {
        json["seconds"] = *seconds;
    }
    return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string pvs_tables(const VisibleSets& sets) {
    const std::vector<std::size_t> triangles = triangles_per_cell(sets);
    std::vector<CellId> order(sets.cells().size());
    std::iota(order.begin(), order.end(), CellId{0});
    std::stable_sort(order.begin(), order.end(), [&](CellId a, CellId b) {
        return triangles[a] > triangles[b];
    });
    std::string text =
        "\nCells that see the most:\n\n    cell      volume, m3   objects  triangles\n";
    for (std::size_t i = 0; i < std::min(kMaxRows, order.size()); ++i) {
        const CellId cell = order[i];
        text += formatted("%8u %15.6g %9zu %10zu\n",
                          cell,
                          sets.cells().volumes()[cell],
                          sets.sets()[cell].size(),
                          triangles[cell]);
    }
    if (!sets.history() || sets.cells().size() < 2) {
        return text;
    }
    text += "\nFewer cells (earshot pvs extract):\n\n    cells   average cost     entries\n";
    for (std::size_t cells = sets.cells().size(); cells > 0; cells /= 2) {
        text += formatted("%9zu %14.6g %11llu\n",
                          cells,
                          sets.history()->cost_of(cells),
                          static_cast<unsigned long long>(sets.history()->entries_of(cells)));
    }
    return text;
}

}  // namespace earshot::cli
