// SPDX-License-Identifier: MIT
#include "earshot/io/internal/result_files.h"

#include "earshot/io/internal/json_depth.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 29U;
// Limits that keep the grid of a decay small and its energies finite; no room comes near them.
constexpr double kMaxTime = 100.0;    // seconds
constexpr double kMaxPressure = 1e6;  // re free field at 1 m
constexpr double kMaxEnergy = 1e12;   // likewise, squared

/// The message of nlohmann-json without the number of its kind.
std::string reason(const Json::exception& exception) {
    const std::string_view what = exception.what();
    const std::size_t end = what.find("] ");
    return shortened(end == std::string_view::npos ? what : what.substr(end + 2));
}

}  // namespace

void refuse_result_file(const ReportFile& file, const std::string& what) {
    throw Error(file.name, what, "give results as earshot has written them");
}

Json parse_result_file(const ReportFile& file, const Json::parser_callback_t& callback) {
    if (file.text.size() > kMaxFileBytes) {
        refuse_result_file(file, "is larger than 512 MiB");
    }
    if (exceeds_json_depth(file.text)) {
        refuse_result_file(file,
                           "is nested deeper than " + std::to_string(kMaxJsonDepth) + " levels");
    }
    Json json;
    read_result_file(file, [&] {
        json = Json::parse(file.text, callback);
        if (!json.is_object()) {
            refuse_result_file(file, "is not a JSON object");
        }
    });
    return json;
}

void read_result_file(const ReportFile& file, const std::function<void()>& body) {
    try {
        body();
    } catch (const Json::parse_error& exception) {
        refuse_result_file(file, "is not JSON: " + reason(exception));
    } catch (const Json::exception& exception) {
        refuse_result_file(file, "does not hold what it should: " + reason(exception));
    }
}

std::uint32_t result_index(const ReportFile& file, const Json& json) {
    // Other numbers would be converted, or cannot be.
    if (!json.is_number_unsigned() ||
        json.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
        refuse_result_file(file, "holds " + shortened(json.dump()) + " where an index should be");
    }
    return json.get<std::uint32_t>();
}

double result_number(const ReportFile& file, const Json& json, double min, double max) {
    const double value = json.get<double>();
    if (!(value >= min && value <= max)) {
        refuse_result_file(file,
                           "holds the number " + json_number(value) + ", which is out of range");
    }
    return value;
}

geometry::Vec3 result_point(const ReportFile& file, const Json& json) {
    if (json.size() != 3) {
        refuse_result_file(file, "holds a point without three coordinates");
    }
    constexpr double kMaxCoordinate = 1e12;
    const auto at = [&](std::size_t axis) {
        return result_number(file, json.at(axis), -kMaxCoordinate, kMaxCoordinate);
    };
    return {at(0), at(1), at(2)};
}

audio::Bands result_bands(const ReportFile& file,
                          const Json& json,
                          const std::optional<audio::Bands>& given) {
    const auto list = json.at("bands_hz").get<std::vector<double>>();
    for (const audio::Bands& bands : {audio::Bands::octaves(), audio::Bands::third_octaves()}) {
        if (std::equal(
                list.begin(), list.end(), bands.nominal_hz().begin(), bands.nominal_hz().end())) {
            if (given && given->count() != bands.count()) {
                refuse_result_file(file, "has other bands than the other results");
            }
            return bands;
        }
    }
    refuse_result_file(file, "has bands that are neither octaves nor third octaves");
}

namespace {

/// Reads the files one after another into one table of pairs.
class Reader {
public:
    void read_metrics(const ReportFile& file) {
        const Json json = parse_result_file(file);
        read_result_file(file, [&] {
            bands_ = result_bands(file, json, bands_);
            files_.room = json.contains("room") ? json.at("room") : Json(nullptr);
            for (const Json& pair : json.at("pairs")) {
                pair_of(pair).metrics = pair;
            }
        });
    }

    /// A pair of the reference that is none of the results' is left out.
    void read_reference(const ReportFile& file, const std::string& name) {
        const Json json = parse_result_file(file);
        read_result_file(file, [&] {
            bands_ = result_bands(file, json, bands_);
            bool fits = false;
            for (const Json& pair : json.at("pairs")) {
                const auto known = index_.find(key_of(pair));
                if (known != index_.end()) {
                    Json& reference = files_.pairs[known->second].reference = pair;
                    if (!name.empty()) {
                        reference["name"] = name;
                    }
                    fits = true;
                }
            }
            if (!fits) {
                refuse_result_file(file, "has no pair of source and listener of these results");
            }
        });
    }

    /// Paths come by the hundred thousand: each is taken from the parser when it is complete.
    void read_paths(const ReportFile& file) {
        max_paths_ = max_paths_of(file);
        constexpr int kPairDepth = 2;
        constexpr int kPathDepth = 4;
        ResultPair pair;
        std::vector<Ranked> ranked;
        Json json;
        read_result_file(file, [&] {
            json = parse_result_file(file, [&](int depth, Json::parse_event_t event, Json& parsed) {
                if (event != Json::parse_event_t::object_end) {
                    return true;
                }
                if (depth == kPathDepth) {
                    add_path(file, parsed, pair, ranked);
                } else if (depth == kPairDepth) {
                    add_paths(file, parsed, std::exchange(pair, {}), std::exchange(ranked, {}));
                }
                return depth != kPathDepth && depth != kPairDepth;
            });
            bands_ = result_bands(file, json, bands_);
            if (pressures_ && *pressures_ != bands_->count()) {
                refuse_result_file(file, "has paths of other bands");
            }
        });
    }

    void read_histograms(const ReportFile& file) {
        const Json json = parse_result_file(file);
        read_result_file(file, [&] {
            bands_ = result_bands(file, json, bands_);
            for (const Json& pair : json.at("pairs")) {
                pair_of(pair).late = histogram_in(file, pair);
            }
        });
    }

    void read_sensitivity(const ReportFile& file) {
        const Json json = parse_result_file(file);
        read_result_file(file, [&] {
            bands_ = result_bands(file, json, bands_);
            files_.materials = json.at("materials");
            if (!files_.materials.is_array()) {
                refuse_result_file(file, "has no list of materials");
            }
            for (const Json& material : files_.materials) {
                static_cast<void>(material.at("name").get<std::string>());
            }
            for (const Json& pair : json.at("pairs")) {
                Json& known = pair_of(pair).sensitivity;
                for (const char* const key : {"energy", "derivatives", "standard_error"}) {
                    known[key] = pair.at(key);
                }
                if (known["energy"].size() != files_.materials.size()) {
                    refuse_result_file(file, "does not have all materials of a pair");
                }
            }
        });
    }

    ResultFiles finish() && {
        files_.bands = bands_.value_or(audio::Bands::octaves());
        return std::move(files_);
    }

private:
    using Key = std::tuple<std::string, std::string, double>;

    /// Of each pair. The file is not parsed yet: each of its pairs has one such key.
    static std::size_t max_paths_of(const ReportFile& file) {
        constexpr std::string_view kKey = "\"paths\"";
        constexpr std::size_t kMinPaths = 20;
        std::size_t pairs = 0;
        for (std::size_t at = file.text.find(kKey); at != std::string::npos;
             at = file.text.find(kKey, at + kKey.size())) {
            ++pairs;
        }
        return std::clamp(
            kMaxReportPaths / std::max<std::size_t>(pairs, 1), kMinPaths, kMaxReportPathsOfPair);
    }

    /// A path with the energy that it brings, over all bands.
    struct Ranked {
        double energy = 0.0;
        std::size_t index = 0;
        std::string text{};

        /// The strongest first; of equal ones the first.
        friend bool operator<(const Ranked& a, const Ranked& b) noexcept {
            return a.energy != b.energy ? a.energy > b.energy : a.index < b.index;
        }
    };

    static Key key_of(const Json& pair) {
        return {pair.at("source").get<std::string>(),
                pair.at("listener").get<std::string>(),
                pair.value("time", 0.0)};
    }

    ResultPair& pair_of(const Json& pair) {
        const Key key = key_of(pair);
        const auto [known, is_new] = index_.try_emplace(key, files_.pairs.size());
        if (is_new) {
            files_.pairs.push_back({.source = std::get<0>(key),
                                    .listener = std::get<1>(key),
                                    .time = std::get<2>(key)});
        }
        return files_.pairs[known->second];
    }

    void add_path(const ReportFile& file,
                  const Json& path,
                  ResultPair& pair,
                  std::vector<Ranked>& ranked) {
        const Json& points = path.at("points");
        if (!points.is_array() || points.size() < 2) {
            refuse_result_file(file, "has a path without two points");
        }
        for (const Json& point : points) {
            result_point(file, point);
        }
        pair.source_position = result_point(file, points.front());
        pair.listener_position = result_point(file, points.back());
        audio::Arrival arrival{.delay = result_number(file, path.at("delay"), 0.0, kMaxTime)};
        const Json& pressure = path.at("pressure");
        if (pressures_.value_or(pressure.size()) != pressure.size() ||
            pressure.size() > audio::kMaxBands) {
            refuse_result_file(file, "has paths of other bands");
        }
        pressures_ = pressure.size();
        double energy = 0.0;
        for (std::size_t band = 0; band < pressure.size(); ++band) {
            const double value =
                result_number(file, pressure.at(band), -kMaxPressure, kMaxPressure);
            arrival.pressure[band] = std::abs(value);
            energy += value * value;
        }
        keep_if_strong({.energy = energy, .index = pair.arrivals.size()}, path, ranked);
        pair.arrivals.push_back(arrival);
    }

    /// `ranked` is a heap, the weakest of the strongest on top.
    void keep_if_strong(Ranked path, const Json& json, std::vector<Ranked>& ranked) const {
        if (ranked.size() == max_paths_) {
            if (!(path < ranked.front())) {
                return;
            }
            std::pop_heap(ranked.begin(), ranked.end());
            ranked.pop_back();
        }
        path.text = json_text(json);
        ranked.push_back(std::move(path));
        std::push_heap(ranked.begin(), ranked.end());
    }

    void add_paths(const ReportFile& file,
                   const Json& json,
                   ResultPair pair,
                   std::vector<Ranked> ranked) {
        std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
            return a.index < b.index;
        });
        ResultPair& known = pair_of(json);
        if (!known.arrivals.empty()) {
            refuse_result_file(file, "has a pair twice");
        }
        known.source_position = pair.source_position;
        known.listener_position = pair.listener_position;
        known.arrivals = std::move(pair.arrivals);
        for (Ranked& path : ranked) {
            known.strongest_paths.push_back(std::move(path.text));
        }
    }

    /// A list per band of values per bin.
    void add_bins(const ReportFile& file,
                  const Json& rows,
                  std::vector<audio::Spectrum>& bins) const {
        if (rows.size() != bands_->count()) {
            refuse_result_file(file, "has histograms of other bands");
        }
        bins.resize(rows.at(0).size());
        for (std::size_t band = 0; band < rows.size(); ++band) {
            const Json& row = rows.at(band);
            if (!row.is_array() || row.size() != bins.size()) {
                refuse_result_file(file, "has histograms of different length");
            }
            for (std::size_t n = 0; n < bins.size(); ++n) {
                bins[n][band] = result_number(file, row[n], 0.0, kMaxEnergy);
            }
        }
    }

    audio::EnergyHistogram histogram_in(const ReportFile& file, const Json& pair) const {
        audio::EnergyHistogram late{.bin = result_number(file, pair.at("bin"), 1e-6, kMaxTime)};
        add_bins(file, pair.at("energy"), late.energy);
        add_bins(file, pair.at("error"), late.error);
        if (late.error.size() != late.energy.size() ||
            late.bin * static_cast<double>(late.energy.size()) > kMaxTime) {
            refuse_result_file(file, "has a histogram that is too long, or has not all errors");
        }
        return late;
    }

    std::size_t max_paths_ = kMaxReportPathsOfPair;
    ResultFiles files_;
    std::map<Key, std::size_t> index_;
    std::optional<audio::Bands> bands_;
    std::optional<std::size_t> pressures_;  // per path
};

}  // namespace

ResultFiles read_result_files(const RoomReport& report) {
    Reader reader;
    if (!report.metrics.text.empty()) {
        reader.read_metrics(report.metrics);
    }
    if (!report.paths.text.empty()) {
        reader.read_paths(report.paths);
    }
    if (!report.histograms.text.empty()) {
        reader.read_histograms(report.histograms);
    }
    if (!report.sensitivity.text.empty()) {
        reader.read_sensitivity(report.sensitivity);
    }
    if (!report.reference.text.empty()) {
        reader.read_reference(report.reference, report.reference_name);
    }
    return std::move(reader).finish();
}

}  // namespace earshot::io
