// SPDX-License-Identifier: MIT
#include "earshot/cli/map_summary.h"

#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/propagation/plausibility.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace earshot::cli {
namespace {

using Json = nlohmann::ordered_json;
using geometry::Vec3;
using propagation::MapLimit;
using propagation::MetricMap;
using propagation::short_text;

std::string point_text(const Vec3& point) {
    return short_text(point.x) + "," + short_text(point.y) + "," + short_text(point.z);
}

std::string percent_text(double share) {
    return formatted("%.1f %%", 100.0 * share);
}

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(width, text.size() + 1), ' ');
    return text;
}

std::string excluded_text(const propagation::ExclusionCounts& excluded) {
    std::string text;
    for (const auto& [count, reason] : {std::pair(excluded.outside, "outside of the room"),
                                        std::pair(excluded.in_solid, "in solids"),
                                        std::pair(excluded.near_surface, "too near to surfaces")}) {
        if (count > 0) {
            text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + reason;
        }
    }
    return text.empty() ? text : "; left out: " + text;
}

/// The median; the vector is reordered. Precondition: there is a value.
double median_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

MapSummary::MapSummary(const propagation::Scene& scene,
                       const MetricMap& map,
                       const std::vector<MapLimit>& limits)
    : scene_(scene), map_(map) {
    for (const MapLimit& limit : limits) {
        for (std::size_t source = 0; source < map.sources.size(); ++source) {
            answers_.push_back({.limit = &limit,
                                .source = source,
                                .result = propagation::evaluate_limit(map, limit, source)});
        }
    }
}

double MapSummary::min_share() const noexcept {
    double share = 1.0;
    for (const LimitAnswer& answer : answers_) {
        share = std::min(share, answer.result.share);
    }
    return share;
}

double MapSummary::area() const {
    double area = 0.0;
    for (std::size_t k = 0; map_.lattice.sheets() > 0 && k < map_.cells.size(); ++k) {
        area += map_.area(k);
    }
    return area;
}

MapSummary::Range MapSummary::range_of(std::size_t source, std::size_t metric) const {
    std::vector<double> values, errors;
    for (std::size_t k = 0; k < map_.cells.size(); ++k) {
        const propagation::MapValue& value = map_.value(k, source, metric);
        if (value.value) {
            values.push_back(*value.value);
            errors.push_back(value.standard_error.value_or(0.0));
        }
    }
    if (values.empty()) {
        return {};
    }
    const auto [min, max] = std::minmax_element(values.begin(), values.end());
    Range range{.known = values.size(), .min = *min, .max = *max};
    range.median = median_of(values);
    range.standard_error = median_of(errors);
    return range;
}

std::string MapSummary::limit_text(const LimitAnswer& answer) const {
    const propagation::MapMetric& metric = map_.metrics[answer.limit->metric];
    const propagation::MapLimitResult& result = answer.result;
    const std::string unit = metric.unit().empty() ? "" : " " + std::string(metric.unit());
    std::string text = on_one_line(map_.sources[answer.source]) + ": " + metric.name() +
                       (answer.limit->is_minimum ? " at least " : " at most ") +
                       short_text(answer.limit->value) + unit + " on " +
                       percent_text(result.share) +
                       (map_.lattice.sheets() > 0 ? " of the area" : " of the points");
    if (result.uncertain_share > 0.0) {
        text += " (" + percent_text(result.uncertain_share) + " within two standard errors of it)";
    }
    if (result.unknown_share > 0.0) {
        text += ", unknown on " + percent_text(result.unknown_share);
    }
    if (result.worst) {
        text += "; worst " + short_text(*result.worst) + unit + " at " +
                point_text(map_.cells[result.worst_cell].point);
    }
    return text + "\n";
}

std::string MapSummary::text(double seconds, const std::vector<std::string>& files) const {
    std::string text =
        on_one_line(scene_.name) + ": " + std::to_string(map_.cells.size()) +
        (map_.lattice.sheets() > 0 ? " cells, " + short_text(area()) + " m2; " +
                                         std::to_string(map_.points_evaluated) + " points evaluated"
                                   : " points") +
        excluded_text(map_.excluded) + "\n\n";
    constexpr std::size_t kNameWidth = 24, kColumnWidth = 10;
    text += padded("", kNameWidth);
    for (const char* column : {"min", "median", "max", "error", "unknown"}) {
        text += padded(column, kColumnWidth);
    }
    text += "\n";
    for (std::size_t source = 0; source < map_.sources.size(); ++source) {
        for (std::size_t metric = 0; metric < map_.metrics.size(); ++metric) {
            const propagation::MapMetric& kind = map_.metrics[metric];
            const std::string unit = kind.unit().empty() ? "" : ", " + std::string(kind.unit());
            const Range range = range_of(source, metric);
            text +=
                padded(on_one_line(map_.sources[source]) + " " + kind.name() + unit, kNameWidth);
            for (const double value : {range.min, range.median, range.max, range.standard_error}) {
                text += padded(range.known > 0 ? short_text(value) : "-", kColumnWidth);
            }
            const std::size_t in_air =
                map_.cells.size() - (map_.lattice.sheets() > 0 ? 0 : map_.excluded.total());
            text += std::to_string(in_air - range.known) + "\n";
        }
    }
    text += answers_.empty() ? "" : "\n";
    for (const LimitAnswer& answer : answers_) {
        text += limit_text(answer);
    }
    text += "\n" + short_text(seconds) + " s";
    for (const std::string& file : files) {
        text += (&file == &files.front() ? "; wrote " : ", ") + on_one_line(file);
    }
    return text + "\n";
}

std::string MapSummary::json(double seconds, const std::vector<std::string>& files) const {
    Json maps = Json::array();
    for (std::size_t source = 0; source < map_.sources.size(); ++source) {
        for (std::size_t metric = 0; metric < map_.metrics.size(); ++metric) {
            const Range range = range_of(source, metric);
            const auto known = [&](double value) {
                return range.known > 0 ? Json(value) : Json(nullptr);
            };
            maps.push_back({{"source", map_.sources[source]},
                            {"metric", map_.metrics[metric].name()},
                            {"unit", std::string(map_.metrics[metric].unit())},
                            {"min", known(range.min)},
                            {"median", known(range.median)},
                            {"max", known(range.max)},
                            {"standard_error", known(range.standard_error)},
                            {"known", range.known}});
        }
    }
    Json limits = Json::array();
    for (const LimitAnswer& answer : answers_) {
        Json worst = nullptr;
        if (answer.result.worst) {
            const Vec3& at = map_.cells[answer.result.worst_cell].point;
            worst = {{"value", *answer.result.worst}, {"point", {at.x, at.y, at.z}}};
        }
        limits.push_back({{"source", map_.sources[answer.source]},
                          {"metric", map_.metrics[answer.limit->metric].name()},
                          {"limit", answer.limit->value},
                          {"is_minimum", answer.limit->is_minimum},
                          {"share", answer.result.share},
                          {"uncertain_share", answer.result.uncertain_share},
                          {"unknown_share", answer.result.unknown_share},
                          {"worst", std::move(worst)}});
    }
    const Json summary = {{"version", 1},
                          {"scene", scene_.name},
                          {"time", map_.time},
                          {"cells", map_.cells.size()},
                          {"area", area()},
                          {"points_evaluated", map_.points_evaluated},
                          {"points_uncertain", map_.points_uncertain},
                          {"excluded",
                           {{"outside", map_.excluded.outside},
                            {"in_solid", map_.excluded.in_solid},
                            {"near_surface", map_.excluded.near_surface}}},
                          {"maps", std::move(maps)},
                          {"limits", std::move(limits)},
                          {"seconds", seconds},
                          {"files", files}};
    constexpr int kIndent = 2;
    return summary.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace earshot::cli
