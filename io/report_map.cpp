// SPDX-License-Identifier: MIT
#include "earshot/io/report_map.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/report_blocks.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <optional>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using propagation::MapLimit;
using propagation::MapLimitResult;
using propagation::MapMetric;
using propagation::MetricMap;

Json list_of(const geometry::Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json json_of(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

/// "STI", "T30 at 125 Hz".
std::string title_of(const MapMetric& metric) {
    std::string name = metric.name();
    const std::size_t colon = name.find(':');
    for (std::size_t i = 0; i < std::min(colon, name.size()); ++i) {
        name[i] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[i])));
    }
    return colon == std::string::npos
               ? name
               : name.substr(0, colon) + " at " + name.substr(colon + 1) + " Hz";
}

std::string text_of(double value, const MapMetric& metric) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), metric.unit() == "dB" ? "%.1f" : "%.2f", value);
    return text.data() + (metric.unit().empty() ? "" : " " + std::string(metric.unit()));
}

/// What values of a source and metric are.
struct Range {
    double lowest = 0.0, highest = 0.0;
    double mean = 0.0;  // over the area
    std::size_t count = 0;
};

Range range_of(const MetricMap& map, std::size_t source, std::size_t metric) {
    Range range;
    double area = 0.0;
    for (std::size_t cell = 0; cell < map.cells.size(); ++cell) {
        const auto& value = map.value(cell, source, metric).value;
        if (value) {
            range.lowest = range.count == 0 ? *value : std::min(range.lowest, *value);
            range.highest = range.count == 0 ? *value : std::max(range.highest, *value);
            range.mean += *value * map.area(cell);
            area += map.area(cell);
            ++range.count;
        }
    }
    range.mean = area > 0.0 ? range.mean / area : 0.0;
    return range;
}

/// The cells of one sheet of one source and metric.
class SheetMap {
public:
    SheetMap(const MetricMap& map, std::size_t source, std::size_t metric, std::size_t sheet)
        : map_(map), source_(source), metric_(metric), sheet_(sheet) {}

    Json json() const {
        Json points = Json::array();
        Json values = Json::array();
        Json errors = Json::array();
        Json cells = Json::array();
        for (std::size_t i = 0; i < map_.cells.size(); ++i) {
            const auto& [cell, point] = map_.cells[i];
            if (cell.sheet != sheet_) {
                continue;
            }
            const propagation::MapValue& value = map_.value(i, source_, metric_);
            points.push_back(list_of(point));
            values.push_back(json_of(value.value));
            errors.push_back(json_of(value.standard_error));
            if (cell.size > 0) {
                cells.push_back({cell.column * map_.lattice.cell_width(),
                                 cell.row * map_.lattice.cell_depth(),
                                 cell.end_column(map_.lattice) * map_.lattice.cell_width(),
                                 cell.end_row(map_.lattice) * map_.lattice.cell_depth(),
                                 json_of(value.value)});
            }
        }
        const MapMetric& metric = map_.metrics[metric_];
        const Range range = range_of(map_, source_, metric_);
        Json json = {{"metric", metric.name()},
                     {"unit", metric.unit()},
                     {"source", source_},
                     {"sheet", sheet_},
                     {"jnd", metric.just_noticeable_difference(range.mean)},
                     {"plane", plane(points)},
                     {"points", std::move(points)},
                     {"values", std::move(values)},
                     {"errors", std::move(errors)}};
        if (!cells.empty()) {
            json["cells"] = std::move(cells);
        }
        return json;
    }

private:
    /// At the lowest of the points; x and z are its axes.
    Json plane(const Json& points) const {
        double height = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double y = points[i][1].get<double>();
            height = i == 0 ? y : std::min(height, y);
        }
        const bool has_cells = map_.lattice.sheets() > 0;
        const geometry::Vec3 origin = {has_cells ? map_.lattice.x_at(0.0) : 0.0,
                                       height,
                                       has_cells ? map_.lattice.z_at(0.0) : 0.0};
        return {{"origin", list_of(origin)},
                {"u", Json::array({1.0, 0.0, 0.0})},
                {"v", Json::array({0.0, 0.0, 1.0})}};
    }

    const MetricMap& map_;
    std::size_t source_, metric_, sheet_;
};

Json maps_block(const MapPage& page, Warnings& warnings) {
    const MetricMap& map = page.map;
    const std::size_t sheets = std::max<std::size_t>(map.lattice.sheets(), 1);
    Json maps = Json::array();
    std::size_t values = 0;
    for (std::size_t source = 0; source < map.sources.size(); ++source) {
        for (std::size_t metric = 0; metric < map.metrics.size(); ++metric) {
            values += map.cells.size();
            if (values > kMaxReportMapValues && !maps.empty()) {
                continue;
            }
            const auto limit = std::find_if(page.limits.begin(),
                                            page.limits.end(),
                                            [&](const MapLimit& l) { return l.metric == metric; });
            for (std::size_t sheet = 0; sheet < sheets; ++sheet) {
                Json json = SheetMap(map, source, metric, sheet).json();
                if (limit != page.limits.end()) {
                    const MapLimitResult result = propagation::evaluate_limit(map, *limit, source);
                    json["limit"] = limit->value;
                    json["share"] = result.share;
                    Json contours = Json::array();
                    for (const auto& line :
                         sheet == 0 ? result.contours : decltype(result.contours){}) {
                        Json points = Json::array();
                        for (const geometry::Vec3& point : line) {
                            points.push_back(list_of(point));
                        }
                        contours.push_back(std::move(points));
                    }
                    json["contour"] = std::move(contours);
                }
                maps.push_back(std::move(json));
            }
        }
    }
    if (values > kMaxReportMapValues && maps.size() < map.sources.size() * map.metrics.size()) {
        warnings.push_back({page.title,
                            "the page shows the first " + std::to_string(maps.size()) +
                                " maps; there are too many points"});
    }
    return maps;
}

std::string of_source(const MetricMap& map, std::size_t source) {
    return map.sources.size() > 1 ? " from " + map.sources[source] : "";
}

Json limit_line(const MapPage& page, const MapLimit& limit, std::size_t source) {
    const MapMetric& metric = page.map.metrics[limit.metric];
    const MapLimitResult result = propagation::evaluate_limit(page.map, limit, source);
    std::array<char, 32> share{};
    std::snprintf(share.data(), share.size(), "%.1f %%", 100.0 * result.share);
    std::string answer = std::string("on ") + share.data() + " of the area";
    if (result.worst) {
        const geometry::Vec3& at = page.map.cells[result.worst_cell].point;
        std::array<char, 96> place{};
        std::snprintf(place.data(), place.size(), " at (%.2f, %.2f, %.2f)", at.x, at.y, at.z);
        answer += "; worst " + text_of(*result.worst, metric) + place.data();
    }
    return {{"question",
             "Is " + title_of(metric) + (limit.is_minimum ? " at least " : " at most ") +
                 text_of(limit.value, metric) + of_source(page.map, source) + "?"},
            {"answer", answer},
            {"state", result.share >= page.min_share ? "met" : "missed"}};
}

Json verdict_of(const MapPage& page) {
    Json verdict = Json::array();
    for (std::size_t source = 0; source < page.map.sources.size(); ++source) {
        for (const MapLimit& limit : page.limits) {
            verdict.push_back(limit_line(page, limit, source));
        }
        for (std::size_t i = 0; i < page.map.metrics.size(); ++i) {
            const MapMetric& metric = page.map.metrics[i];
            const Range range = range_of(page.map, source, i);
            verdict.push_back(
                {{"question", "What is " + title_of(metric) + of_source(page.map, source) + "?"},
                 {"answer",
                  range.count == 0
                      ? "not known anywhere"
                      : text_of(range.lowest, metric) + " to " + text_of(range.highest, metric) +
                            ", mean " + text_of(range.mean, metric)},
                 {"state", "told"}});
        }
    }
    return verdict;
}

}  // namespace

std::string encode_map_page(const MapPage& page) {
    Warnings warnings = page.warnings;
    const geometry::Vec3 size = propagation::scene_extent(page.scene, page.map.time).size();
    Json sources = Json::array();
    for (std::size_t i = 0; i < page.map.sources.size(); ++i) {
        sources.push_back(
            {{"name", page.map.sources[i]}, {"position", list_of(page.map.source_positions[i])}});
    }
    Json data = {
        {"format", 1},
        {"kind", "map"},
        {"title", page.title},
        {"provenance", provenance_block(page.provenance, scene_digest(page.scene, page.map.time))},
        {"verdict", verdict_of(page)},
        {"room", {{"extent", list_of(size)}}},
        {"bands",
         std::vector<double>(page.bands.nominal_hz().begin(), page.bands.nominal_hz().end())},
        {"scene", scene_block(page.scene, page.map.time, warnings)},
        {"materials",
         materials_block(page.scene, page.map.time, page.default_materials, page.bands)},
        {"sources", std::move(sources)},
        {"maps", maps_block(page, warnings)}};
    data["warnings"] = warnings_block(warnings);
    return json_text(data) + "\n";
}

}  // namespace earshot::io
