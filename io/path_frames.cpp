// SPDX-License-Identifier: MIT
#include "earshot/io/path_frames.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/geometry/vector.h"
#include "earshot/io/internal/result_files.h"
#include "earshot/io/name_choice.h"
#include "earshot/io/whole_file.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using propagation::Path;
using propagation::PathFrame;
using propagation::PathKind;

// Limits that keep what is rendered small; no scene comes near them.
constexpr double kMaxCoordinate = 1e5;  // metres
constexpr double kMaxPressure = 1e6;    // re free field at 1 m
constexpr double kMaxTime = 1e9;        // seconds
constexpr double kMinSpeedOfSound = 100.0, kMaxSpeedOfSound = 2000.0;
constexpr std::size_t kMaxOrder = 100;
// The turn of a way, twice the cosine at a reflection, up to which it goes straight on.
constexpr double kMaxTurn = 1e-7;
constexpr double kMaxAxisDeviation = 1e-6;  // of length from 1, and of a cosine from 0

PathKind kind_of(const ReportFile& file, const std::string& name) {
    for (const PathKind kind :
         {PathKind::direct, PathKind::specular, PathKind::transmitted, PathKind::diffracted}) {
        if (propagation::name_of(kind) == name) {
            return kind;
        }
    }
    refuse_result_file(file, "has a path of an unknown kind");
}

geometry::Vec3 point_of(const ReportFile& file, const Json& json) {
    const geometry::Vec3 point = result_point(file, json);
    if (geometry::max_abs(point) > kMaxCoordinate) {
        refuse_result_file(file, "has a point that is more than 100 km away");
    }
    return point;
}

/// Whether the way goes straight on at a point.
bool goes_on(const geometry::Vec3& from, const geometry::Vec3& at, const geometry::Vec3& to) {
    return glm::distance(geometry::direction_between(from, at),
                         geometry::direction_between(at, to)) <= kMaxTurn;
}

/// Which interactions let sound pass is not told: the way goes straight on there.
std::vector<std::uint8_t> transmitted_of(const Path& path) {
    std::vector<std::uint8_t> transmitted;
    for (std::size_t i = 0; i < path.triangles.size(); ++i) {
        const bool passes = goes_on(path.points[i], path.points[i + 1], path.points[i + 2]);
        transmitted.push_back(passes ? 1 : 0);
    }
    return transmitted;
}

void read_edges(const ReportFile& file, const Json& json, Path& path) {
    if (!json.is_array() || json.size() != 1 || path.triangles.empty()) {
        throw Error(file.name,
                    "has a path that does not bend round one edge",
                    "compute the paths with --diffraction 1");
    }
    const Json& edge = json.front();
    if (!edge.is_array() || edge.size() != 2) {
        refuse_result_file(file, "has an edge without two ends");
    }
    path.edges = {{point_of(file, edge.at(0)), point_of(file, edge.at(1))}};
}

void read_pressure(const ReportFile& file, const Json& json, Path& path) {
    if (!json.is_array() || json.size() > audio::kMaxBands) {
        refuse_result_file(file, "has paths of other bands");
    }
    for (std::size_t band = 0; band < json.size(); ++band) {
        path.pressure[band] = result_number(file, json.at(band), -kMaxPressure, kMaxPressure);
    }
    const auto [lowest, highest] = std::minmax_element(path.pressure.begin(), path.pressure.end());
    if (*lowest < 0.0 && *highest > 0.0) {
        refuse_result_file(file, "has a path whose pressure changes sign between bands");
    }
}

Path path_of(const ReportFile& file, const Json& json) {
    Path path{.kind = kind_of(file, json.at("kind").get<std::string>())};
    const Json& points = json.at("points");
    const Json& triangles = json.at("triangles");
    if (!points.is_array() || !triangles.is_array() || points.size() != triangles.size() + 2 ||
        triangles.size() > kMaxOrder) {
        refuse_result_file(file, "has a path without a point per triangle and two ends");
    }
    for (const Json& point : points) {
        path.points.push_back(point_of(file, point));
    }
    for (const Json& triangle : triangles) {
        path.triangles.push_back(result_index(file, triangle));
    }
    if (path.kind == PathKind::transmitted || path.kind == PathKind::diffracted) {
        path.transmitted = transmitted_of(path);
    }
    if (path.kind == PathKind::diffracted) {
        read_edges(file, json.at("edges"), path);
    }
    read_pressure(file, json.at("pressure"), path);
    return path;
}

/// Files of earlier versions do not tell how the listener is turned: then along -Z.
void read_orientation(const ReportFile& file, const Json& json, PathFrame& frame) {
    if (!json.contains("listener_front") && !json.contains("listener_up")) {
        return;
    }
    frame.listener_front = result_point(file, json.at("listener_front"));
    frame.listener_up = result_point(file, json.at("listener_up"));
    const auto is_one = [](double value) { return std::abs(value - 1.0) <= kMaxAxisDeviation; };
    if (!is_one(glm::length(frame.listener_front)) || !is_one(glm::length(frame.listener_up)) ||
        !(std::abs(glm::dot(frame.listener_front, frame.listener_up)) <= kMaxAxisDeviation)) {
        refuse_result_file(file, "has a listener whose axes are no unit vectors at right angles");
    }
}

/// The pairs of a file, by their names.
class PairTable {
public:
    explicit PairTable(const ReportFile& file) : file_(file) {}

    void add(const Json& json, std::vector<Path> paths) {
        const std::pair names(json.at("source").get<std::string>(),
                              json.at("listener").get<std::string>());
        if (!json.at("paths").is_array()) {
            refuse_result_file(file_, "has a pair without a list of paths");
        }
        const auto [known, is_new] = index_.try_emplace(names, pairs_.size());
        if (is_new) {
            pairs_.push_back({.source = names.first, .listener = names.second});
        }
        PathFrame frame{.time = result_number(file_, json.at("time"), -kMaxTime, kMaxTime),
                        .paths = std::move(paths)};
        read_orientation(file_, json, frame);
        pairs_[known->second].frames.instants.push_back(std::move(frame));
    }

    std::vector<PairPathFrames> finish(const Json& header) {
        const audio::Bands bands = result_bands(file_, header, std::nullopt);
        const double speed =
            result_number(file_, header.at("speed_of_sound"), kMinSpeedOfSound, kMaxSpeedOfSound);
        if (pairs_.empty()) {
            refuse_result_file(file_, "has no pair of source and listener");
        }
        for (PairPathFrames& pair : pairs_) {
            pair.frames.name = file_.name;
            pair.frames.bands = bands;
            pair.frames.speed_of_sound = speed;
            sort(pair.frames.instants);
        }
        return std::move(pairs_);
    }

private:
    void sort(std::vector<PathFrame>& instants) const {
        const auto is_earlier = [](const PathFrame& a, const PathFrame& b) {
            return a.time < b.time;
        };
        std::stable_sort(instants.begin(), instants.end(), is_earlier);
        for (std::size_t i = 1; i < instants.size(); ++i) {
            if (!is_earlier(instants[i - 1], instants[i])) {
                refuse_result_file(file_, "has a pair twice at a time");
            }
        }
    }

    const ReportFile& file_;
    std::vector<PairPathFrames> pairs_;
    std::map<std::pair<std::string, std::string>, std::size_t> index_;
};

}  // namespace

std::vector<PairPathFrames> read_path_frames(const std::filesystem::path& file) {
    const ReportFile text{.name = file.string(), .text = read_whole_file(file)};
    // Paths come by the hundred thousand: each is taken from the parser when it is complete.
    constexpr int kPairDepth = 2;
    constexpr int kPathDepth = 4;
    PairTable pairs(text);
    std::vector<Path> paths;
    std::optional<std::size_t> bands;
    const auto take = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (event != Json::parse_event_t::object_end) {
            return true;
        }
        if (depth == kPathDepth) {
            paths.push_back(path_of(text, parsed));
            const std::size_t count = parsed.at("pressure").size();
            if (bands.value_or(count) != count) {
                refuse_result_file(text, "has paths of other bands");
            }
            bands = count;
        } else if (depth == kPairDepth) {
            pairs.add(parsed, std::exchange(paths, {}));
        }
        return depth != kPathDepth && depth != kPairDepth;
    };
    std::vector<PairPathFrames> result;
    read_result_file(text, [&] {
        const Json header = parse_result_file(text, take);
        result = pairs.finish(header);
        if (bands && *bands != result.front().frames.bands.count()) {
            refuse_result_file(text, "has paths of other bands");
        }
    });
    return result;
}

namespace {

void add_if_new(const std::string& name, std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
        names.push_back(name);
    }
}

}  // namespace

const propagation::PathFrames& frames_of_pair(std::span<const PairPathFrames> pairs,
                                              const PairNames& names) {
    EARSHOT_ASSERT(!pairs.empty());
    const std::string& file = pairs.front().frames.name;
    std::vector<std::string> sources, listeners;
    for (const PairPathFrames& pair : pairs) {
        add_if_new(pair.source, sources);
        add_if_new(pair.listener, listeners);
    }
    const std::string& from = sources[find_name(
        file, sources, {.role = "source", .option = names.source_option, .name = names.source})];
    const std::string& to = listeners[find_name(
        file,
        listeners,
        {.role = "listener", .option = names.listener_option, .name = names.listener})];
    for (const PairPathFrames& pair : pairs) {
        if (pair.source == from && pair.listener == to) {
            return pair.frames;
        }
    }
    throw Error(file, "has no pair of " + from + " and " + to, "choose another");
}

}  // namespace earshot::io
