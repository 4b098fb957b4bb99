// SPDX-License-Identifier: MIT
#include "earshot/io/map_table.h"

#include "earshot/io/escape.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <optional>

namespace earshot::io {

using geometry::Vec3;
using propagation::MapCell;
using propagation::MapLimit;
using propagation::MapLimitResult;
using propagation::MapValue;
using propagation::MetricMap;

namespace {

using Json = nlohmann::ordered_json;

std::string number_or_nothing(const std::optional<double>& value) {
    return value ? json_number(*value) : std::string();
}

std::string number_or_null(const std::optional<double>& value) {
    return value ? json_number(*value) : "null";
}

double width_of(const MetricMap& map, std::size_t cell) {
    const MapCell& square = map.cells[cell].cell;
    return map.lattice.cell_width() * (square.end_column(map.lattice) - square.column);
}

double depth_of(const MetricMap& map, std::size_t cell) {
    const MapCell& square = map.cells[cell].cell;
    return map.lattice.cell_depth() * (square.end_row(map.lattice) - square.row);
}

/// Numbers of all cells or points between commas, some on a line.
template <typename TextOf>
std::string list(std::size_t count, const TextOf& text_of) {
    constexpr std::size_t kPerLine = 16;
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) {
        text += i == 0 ? "" : i % kPerLine == 0 ? ",\n  " : ",";
        text += text_of(i);
    }
    return text + "]";
}

/// One metric of one source.
class MapEntry {
public:
    MapEntry(const MetricMap& map, std::size_t source, std::size_t metric, const MapLimit* limit)
        : map_(map), source_(source), metric_(metric), limit_(limit) {}

    std::string text() const {
        const propagation::MapMetric& metric = map_.metrics[metric_];
        const Json head = {{"metric", metric.name()},
                           {"unit", std::string(metric.unit())},
                           {"source", source_},
                           {"jnd", metric.step()},
                           {"jnd_is_relative", metric.is_relative()}};
        std::string text = head.dump();
        text.pop_back();
        text += limit_text() + ",\n \"plane\":" + plane_text();
        text += ",\n \"points\":" + list(map_.cells.size(), [&](std::size_t k) {
                    return "[" + json_numbers(map_.cells[k].point) + "]";
                });
        text += ",\n \"values\":" + list(map_.cells.size(), [&](std::size_t k) {
                    return number_or_null(value(k).value);
                });
        text += ",\n \"errors\":" + list(map_.cells.size(), [&](std::size_t k) {
                    return number_or_null(value(k).standard_error);
                });
        text += ",\n \"cells\":" + cells_text();
        return text + ",\n \"contour\":" + contour_text() + "}";
    }

private:
    const MapValue& value(std::size_t cell) const { return map_.value(cell, source_, metric_); }
    bool has_cells() const { return map_.lattice.sheets() > 0; }

    std::string limit_text() const {
        if (limit_ == nullptr) {
            return ",\"limit\":null,\"share\":null";
        }
        const MapLimitResult result = propagation::evaluate_limit(map_, *limit_, source_);
        return ",\"limit\":" + json_number(limit_->value) +
               ",\"limit_is_minimum\":" + (limit_->is_minimum ? "true" : "false") +
               ",\"share\":" + json_number(result.share) +
               ",\"uncertain_share\":" + json_number(result.uncertain_share) +
               ",\"unknown_share\":" + json_number(result.unknown_share);
    }
    /// The corner of the lattice at the height of the first point.
    std::string plane_text() const {
        const Vec3 origin =
            has_cells()
                ? Vec3(map_.lattice.x_at(0.0), map_.cells.front().point.y, map_.lattice.z_at(0.0))
                : Vec3(0.0);
        return "{\"origin\":[" + json_numbers(origin) + "],\"u\":[1,0,0],\"v\":[0,0,1]}";
    }
    std::string cells_text() const {
        return list(has_cells() ? map_.cells.size() : 0, [&](std::size_t k) {
            const MapCell& cell = map_.cells[k].cell;
            const double width = map_.lattice.cell_width(), depth = map_.lattice.cell_depth();
            return "[" + json_number(cell.column * width) + "," + json_number(cell.row * depth) +
                   "," + json_number(cell.end_column(map_.lattice) * width) + "," +
                   json_number(cell.end_row(map_.lattice) * depth) + "," +
                   number_or_null(value(k).value) + "]";
        });
    }
    std::string contour_text() const {
        if (limit_ == nullptr) {
            return "[]";
        }
        const auto lines = propagation::evaluate_limit(map_, *limit_, source_).contours;
        return list(lines.size(), [&](std::size_t i) {
            return list(lines[i].size(),
                        [&](std::size_t k) { return "[" + json_numbers(lines[i][k]) + "]"; });
        });
    }

    const MetricMap& map_;
    std::size_t source_, metric_;
    const MapLimit* limit_;
};

}  // namespace

std::string encode_map_csv(const MetricMap& map) {
    std::string text = "x,y,z,width,depth,excluded";
    for (const std::string& source : map.sources) {
        for (const propagation::MapMetric& metric : map.metrics) {
            const std::string column = escape_controls(source) + "/" + metric.name();
            text += "," + csv_field(column) + "," + csv_field(column + "/error");
        }
    }
    text += "\n";
    for (std::size_t k = 0; k < map.cells.size(); ++k) {
        text += json_numbers(map.cells[k].point);
        text += map.lattice.sheets() > 0
                    ? "," + json_number(width_of(map, k)) + "," + json_number(depth_of(map, k))
                    : ",,";
        text += "," + std::string(name_of(map.exclusions[k]));
        for (std::size_t source = 0; source < map.sources.size(); ++source) {
            for (std::size_t metric = 0; metric < map.metrics.size(); ++metric) {
                const MapValue& value = map.value(k, source, metric);
                text += "," + number_or_nothing(value.value) + "," +
                        number_or_nothing(value.standard_error);
            }
        }
        text += "\n";
    }
    return text;
}

std::string encode_map_json(std::string_view scene,
                            const MetricMap& map,
                            std::span<const MapLimit> limits) {
    JsonLines lines;
    Json sources = Json::array();
    for (std::size_t i = 0; i < map.sources.size(); ++i) {
        const Vec3& at = map.source_positions[i];
        sources.push_back({{"name", map.sources[i]}, {"position", {at.x, at.y, at.z}}});
    }
    const Json excluded = {{"outside", map.excluded.outside},
                           {"in_solid", map.excluded.in_solid},
                           {"near_surface", map.excluded.near_surface}};
    lines.begin_list("{\"version\":1,\"scene\":" + json_text(std::string(scene)) + ",\"time\":" +
                         json_number(map.time) + ",\n\"sources\":" + json_text(sources) +
                         ",\"excluded\":" + excluded.dump() + ",\n\"maps\":",
                     1);
    for (std::size_t source = 0; source < map.sources.size(); ++source) {
        for (std::size_t metric = 0; metric < map.metrics.size(); ++metric) {
            const auto limit = std::find_if(limits.begin(), limits.end(), [&](const auto& other) {
                return other.metric == metric;
            });
            lines.add_record(
                MapEntry(map, source, metric, limit == limits.end() ? nullptr : &*limit).text());
        }
    }
    lines.end_list();
    return lines.finish();
}

}  // namespace earshot::io
