// SPDX-License-Identifier: MIT
#include "earshot/io/report_map.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/report_blocks.h"
#include "earshot/io/internal/result_files.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <optional>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;

/// "STI", "T30 at 125 Hz".
std::string title_of(const std::string& metric) {
    const std::size_t colon = metric.find(':');
    std::string name = metric.substr(0, colon);
    for (char& c : name) {
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    return colon == std::string::npos ? name : name + " at " + metric.substr(colon + 1) + " Hz";
}

/// A metric of a source over the area.
struct Map {
    Json json;
    std::size_t source = 0;
    std::string metric{}, unit{};
    // Of the values that are known.
    std::size_t count = 0;
    double lowest = 0.0, highest = 0.0, mean = 0.0;

    std::string text_of(double value) const {
        std::array<char, 64> text{};
        std::snprintf(text.data(), text.size(), unit == "dB" ? "%.1f" : "%.2f", value);
        return text.data() + (unit.empty() ? "" : " " + unit);
    }
};

void require_lists(const ReportFile& file, const Json& json) {
    const std::size_t count = json.at("points").size();
    for (const char* const key : {"values", "errors"}) {
        if (json.at(key).size() != count) {
            refuse_result_file(file, "has a map without a value for each point");
        }
    }
    for (const Json& point : json.at("points")) {
        if (point.size() != 3) {
            refuse_result_file(file, "holds a point without three coordinates");
        }
    }
    for (const Json& cell : json.at("cells")) {
        constexpr std::size_t kCellSize = 5;  // two corners and a value
        if (cell.size() != kCellSize) {
            refuse_result_file(file, "has a cell that is no rectangle with a value");
        }
    }
}

Map read_map(const ReportFile& file, const Json& json, std::size_t sources) {
    require_lists(file, json);
    Map map{.json = json,
            .source = result_index(file, json.at("source")),
            .metric = json.at("metric").get<std::string>(),
            .unit = json.at("unit").get<std::string>()};
    if (map.source >= sources) {
        refuse_result_file(file, "has a map of a source that it does not name");
    }
    double sum = 0.0;
    for (const Json& value : json.at("values")) {
        if (!value.is_null()) {
            const auto number = value.get<double>();
            map.lowest = map.count == 0 ? number : std::min(map.lowest, number);
            map.highest = map.count == 0 ? number : std::max(map.highest, number);
            sum += number;
            ++map.count;
        }
    }
    map.mean = map.count > 0 ? sum / static_cast<double>(map.count) : 0.0;
    // The page's steps are in the metric's unit.
    if (json.value("jnd_is_relative", false)) {
        map.json["jnd"] = json.at("jnd").get<double>() * map.mean;
        map.json.erase("jnd_is_relative");
    }
    return map;
}

Json limit_line(const Map& map, const std::string& of_source, double min_share) {
    const bool is_minimum = map.json.value("limit_is_minimum", true);
    const auto share = map.json.at("share").get<double>();
    std::array<char, 32> percent{};
    std::snprintf(percent.data(), percent.size(), "%.1f %%", 100.0 * share);
    std::string answer = std::string("on ") + percent.data() + " of the area";
    if (map.count > 0) {
        answer += "; worst " + map.text_of(is_minimum ? map.lowest : map.highest);
    }
    return {{"question",
             "Is " + title_of(map.metric) + (is_minimum ? " at least " : " at most ") +
                 map.text_of(map.json.at("limit").get<double>()) + of_source + "?"},
            {"answer", answer},
            {"state", share >= min_share ? "met" : "missed"}};
}

Json range_line(const Map& map, const std::string& of_source) {
    return {{"question", "What is " + title_of(map.metric) + of_source + "?"},
            {"answer",
             map.count == 0 ? "not known anywhere"
                            : map.text_of(map.lowest) + " to " + map.text_of(map.highest) +
                                  ", mean of the points " + map.text_of(map.mean)},
            {"state", "told"}};
}

/// What map.json holds, with the answers.
struct MapFile {
    Json sources = Json::array();
    Json verdict = Json::array();
    Json maps = Json::array();
    double time = 0.0;  // seconds
};

MapFile read_map_file(const MapPage& page, Warnings& warnings) {
    MapFile result;
    const Json json = parse_result_file(page.map);
    read_result_file(page.map, [&] {
        result.sources = json.at("sources");
        result.time = json.at("time").get<double>();
        std::size_t values = 0;
        std::size_t left_out = 0;
        for (const Json& entry : json.at("maps")) {
            Map map = read_map(page.map, entry, result.sources.size());
            const std::string of_source =
                result.sources.size() > 1
                    ? " from " + result.sources.at(map.source).at("name").get<std::string>()
                    : "";
            if (map.json.contains("limit") && !map.json.at("limit").is_null()) {
                result.verdict.push_back(limit_line(map, of_source, page.min_share));
            }
            result.verdict.push_back(range_line(map, of_source));
            values += map.json.at("values").size();
            if (values > kMaxReportMapValues && !result.maps.empty()) {
                ++left_out;
            } else {
                result.maps.push_back(std::move(map.json));
            }
        }
        if (left_out > 0) {
            warnings.push_back({page.map.name,
                                "the page leaves out " + std::to_string(left_out) +
                                    " maps: there are too many points"});
        }
    });
    return result;
}

}  // namespace

std::string encode_map_page(const MapPage& page) {
    Warnings warnings = page.warnings;
    MapFile file = read_map_file(page, warnings);
    const audio::Bands& bands = audio::Bands::octaves();
    Json data = {
        {"format", 1},
        {"kind", "map"},
        {"title", page.title},
        {"provenance",
         provenance_block(page.provenance,
                          page.scene == nullptr ? "" : scene_digest(*page.scene, file.time))},
        {"verdict", std::move(file.verdict)},
        {"bands", std::vector<double>(bands.nominal_hz().begin(), bands.nominal_hz().end())}};
    if (page.scene != nullptr) {
        const geometry::Vec3 size = propagation::scene_extent(*page.scene, file.time).size();
        data["room"] = {{"extent", {size.x, size.y, size.z}}};
        data["scene"] = scene_block(*page.scene, file.time, warnings);
        data["materials"] = materials_block(*page.scene, file.time, page.default_materials, bands);
    }
    data["sources"] = std::move(file.sources);
    data["maps"] = std::move(file.maps);
    data["warnings"] = warnings_block(warnings);
    return json_text(data) + "\n";
}

}  // namespace earshot::io
