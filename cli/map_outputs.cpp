// SPDX-License-Identifier: MIT
#include "earshot/cli/map_outputs.h"

#include "earshot/io/map_picture.h"
#include "earshot/io/map_table.h"
#include "earshot/io/result_names.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace earshot::cli {
namespace {

using propagation::MapLimit;
using propagation::MetricMap;

constexpr std::array<std::string_view, 4> kSuffixes = {".csv", ".json", ".svg", ".png"};

std::string suffix_of(const std::string& file) {
    std::string suffix = std::filesystem::path(file).extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return suffix;
}

/// Draws one picture per source and metric.
class Pictures {
public:
    Pictures(const propagation::Scene& scene,
             const MetricMap& map,
             const std::vector<MapLimit>& limits)
        : scene_(scene),
          map_(map),
          limits_(limits),
          positions_(scene.mesh.positions_at(map.time)) {}

    void write(const std::string& file, std::vector<std::string>& written) const {
        std::set<std::string> names;
        for (std::size_t source = 0; source < map_.sources.size(); ++source) {
            for (std::size_t metric = 0; metric < map_.metrics.size(); ++metric) {
                const std::string name = name_of(file, source, metric);
                if (!names.insert(name).second) {
                    throw Error(name, "would hold two pictures", "rename one of the sources");
                }
                const io::MapDrawing drawing = this->drawing(source, metric);
                if (suffix_of(file) == ".svg") {
                    io::write_whole_file(name, io::draw_map_svg(drawing));
                } else {
                    io::write_png(name, io::draw_map_picture(drawing));
                }
                written.push_back(name);
            }
        }
    }

private:
    std::string name_of(const std::string& file, std::size_t source, std::size_t metric) const {
        const std::filesystem::path path(file);
        std::string stem = path.stem().string();
        if (map_.sources.size() > 1) {
            stem += "__" + io::as_file_name(map_.sources[source]);
        }
        if (map_.metrics.size() > 1) {
            stem += "__" + io::as_file_name(map_.metrics[metric].name());
        }
        return (path.parent_path() / (stem + path.extension().string())).string();
    }

    io::MapDrawing drawing(std::size_t source, std::size_t metric) const {
        const auto limit = std::find_if(limits_.begin(), limits_.end(), [&](const MapLimit& other) {
            return other.metric == metric;
        });
        return {.map = map_,
                .source = source,
                .metric = metric,
                .mesh = {positions_, scene_.mesh.triangles()},
                .limit = limit == limits_.end() ? std::nullopt : std::optional(*limit),
                .title = io::map_title(scene_.name, map_, source, metric)};
    }

    const propagation::Scene& scene_;
    const MetricMap& map_;
    const std::vector<MapLimit>& limits_;
    std::vector<geometry::Vec3> positions_;
};

}  // namespace

void MapOutputs::add_to(CLI::App& app) {
    add_repeatable(app,
                   "-o,--output",
                   files_,
                   "a file: .csv or .json for numbers, .svg or .png for a picture of each metric");
}

void MapOutputs::check(const CLI::App& app) const {
    for (const std::string& file : files_) {
        if (std::find(kSuffixes.begin(), kSuffixes.end(), suffix_of(file)) == kSuffixes.end()) {
            throw wrong_usage(
                app, "--output", "'" + file + "' does not end in .csv, .json, .svg or .png");
        }
        if (std::count(files_.begin(), files_.end(), file) > 1) {
            throw wrong_usage(app, "--output", "'" + file + "' is given twice");
        }
        io::require_writable(file);
    }
}

std::filesystem::path MapOutputs::page_file(const CLI::App& app) const {
    if (files_.empty()) {
        throw wrong_usage(app, "--report", "goes with a file of -o, after which the page is named");
    }
    return std::filesystem::path(files_.front()).replace_extension(".html");
}

std::vector<std::string> MapOutputs::write(const propagation::Scene& scene,
                                           const MetricMap& map,
                                           const std::vector<MapLimit>& limits) const {
    std::vector<std::string> written;
    for (const std::string& file : files_) {
        const std::string suffix = suffix_of(file);
        if (suffix == ".csv") {
            io::write_whole_file(file, io::encode_map_csv(map));
            written.push_back(file);
        } else if (suffix == ".json") {
            io::write_whole_file(file, io::encode_map_json(scene.name, map, limits));
            written.push_back(file);
        } else {
            Pictures(scene, map, limits).write(file, written);
        }
    }
    return written;
}

}  // namespace earshot::cli
