// SPDX-License-Identifier: MIT
#include "earshot/cli/map_limit_options.h"

#include "earshot/cli/values.h"

#include <algorithm>
#include <optional>
#include <string_view>

namespace earshot::cli {
namespace {

using propagation::MapLimit;
using propagation::MapMetric;

/// METRIC=VALUE, METRIC>=VALUE or METRIC<=VALUE.
struct LimitText {
    std::string_view metric, value;
    char relation = '=';
};

std::optional<LimitText> parse_limit(std::string_view text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos || equals == 0) {
        return std::nullopt;
    }
    const char before = text[equals - 1];
    const bool has_relation = before == '<' || before == '>';
    return LimitText{.metric = text.substr(0, has_relation ? equals - 1 : equals),
                     .value = text.substr(equals + 1),
                     .relation = has_relation ? before : '='};
}

std::size_t index_of(const std::vector<MapMetric>& metrics, std::string_view name) {
    const auto found = std::find_if(metrics.begin(), metrics.end(), [&](const MapMetric& metric) {
        return metric.name() == name;
    });
    return static_cast<std::size_t>(found - metrics.begin());
}

MapMetric metric_named(const CLI::App& app,
                       const char* option,
                       std::string_view name,
                       const audio::Bands& bands) {
    try {
        return {name, bands};
    } catch (const Error& error) {
        throw wrong_usage(app, option, error.line());
    }
}

}  // namespace

void MapLimitOptions::add_to(CLI::App& app) {
    app.add_option("--metric",
                   metrics_,
                   "what to map, between commas: sti, edt, t20, t30, c50, c80, d50, ts, g (means "
                   "of 500 Hz and 1 kHz), or of one band, t30:125")
        ->capture_default_str()
        ->type_name("METRICS");
    add_repeatable(
        app,
        "--limit",
        limits_,
        "METRIC=VALUE that values should keep: at least, of sti, c50, c80, d50 and g; at "
        "most, of edt, t20, t30 and ts; METRIC>=VALUE and METRIC<=VALUE say it");
    add_number(app,
               "--share",
               share_percent_,
               {0.0, 100.0},
               "percent of the area that must keep every limit, else the exit status is 3");
}

std::vector<MapMetric> MapLimitOptions::metrics(const CLI::App& app,
                                                const audio::Bands& bands) const {
    std::vector<MapMetric> metrics;
    const auto add = [&](const char* option, std::string_view name) {
        if (index_of(metrics, name) == metrics.size()) {
            metrics.push_back(metric_named(app, option, name, bands));
        }
    };
    std::string_view rest = metrics_;
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
        comma = rest.find(',');
        add("--metric", rest.substr(0, comma));
        rest = comma == std::string_view::npos ? rest : rest.substr(comma + 1);
    }
    for (const std::string& text : limits_) {
        if (const auto limit = parse_limit(text)) {
            add("--limit", limit->metric);
        }
    }
    return metrics;
}

std::vector<MapLimit> MapLimitOptions::limits(const CLI::App& app,
                                              const std::vector<MapMetric>& metrics) const {
    if (share_percent_ > 0.0 && limits_.empty()) {
        throw wrong_usage(app, "--share", "says nothing without --limit");
    }
    std::vector<MapLimit> limits;
    for (const std::string& text : limits_) {
        const auto limit = parse_limit(text);
        const auto value = limit ? parse_number(limit->value) : std::nullopt;
        if (!value) {
            throw wrong_usage(app, "--limit", "'" + text + "' is not of the form METRIC=VALUE");
        }
        const std::size_t metric = index_of(metrics, limit->metric);
        if (std::any_of(limits.begin(), limits.end(), [&](const MapLimit& other) {
                return other.metric == metric;
            })) {
            throw wrong_usage(app, "--limit", "'" + metrics[metric].name() + "' has two limits");
        }
        limits.push_back({.metric = metric,
                          .value = *value,
                          .is_minimum = limit->relation == '=' ? metrics[metric].larger_is_better()
                                                               : limit->relation == '>'});
    }
    return limits;
}

}  // namespace earshot::cli
