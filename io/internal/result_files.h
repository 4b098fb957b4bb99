// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/geometry/types.h"
#include "earshot/io/report.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace earshot::io {

/// Parses a file of results that anyone may have written. Throws Error naming the file if it is not
/// JSON, too large or too deep. `callback` as nlohmann-json's.
nlohmann::ordered_json parse_result_file(
    const ReportFile& file, const nlohmann::ordered_json::parser_callback_t& callback = nullptr);

/// Calls `body`; what it finds otherwise than it should be in the JSON of the file becomes an Error
/// that names the file.
void read_result_file(const ReportFile& file, const std::function<void()>& body);

/// Throws Error naming the file and what is wrong with it.
[[noreturn]] void refuse_result_file(const ReportFile& file, const std::string& what);

/// An index that the file holds: a whole number from 0 on. Throws Error naming the file if it is
/// none.
std::uint32_t result_index(const ReportFile& file, const nlohmann::ordered_json& json);

/// A number from `min` to `max`, and a point within 1e12 m. Throw Error naming the file if it is
/// none.
double result_number(const ReportFile& file,
                     const nlohmann::ordered_json& json,
                     double min,
                     double max);
geometry::Vec3 result_point(const ReportFile& file, const nlohmann::ordered_json& json);

/// The bands of a file, which are octaves or thirds. `given`: as another file has them.
audio::Bands result_bands(const ReportFile& file,
                          const nlohmann::ordered_json& json,
                          const std::optional<audio::Bands>& given);

/// A source and a listener at one time, by their names.
struct ResultPair {
    std::string source{}, listener{};
    double time = 0.0;                   ///< seconds
    nlohmann::ordered_json metrics{};    ///< the object of metrics.json, or null
    nlohmann::ordered_json reference{};  ///< that of another run, or null
    std::optional<geometry::Vec3> source_position{}, listener_position{};
    std::vector<audio::Arrival> arrivals{};  ///< of all paths
    /// The objects of paths.json that bring most energy, in their order.
    std::vector<std::string> strongest_paths{};
    audio::EnergyHistogram late{};  ///< without directions
    /// `energy`, `derivatives` and `standard_error` of the object of sensitivity.json, or null.
    nlohmann::ordered_json sensitivity{};
};

/// What the files of a report hold, pairs in the order of the first file that has them.
struct ResultFiles {
    audio::Bands bands = audio::Bands::octaves();
    nlohmann::ordered_json room{};       ///< of metrics.json, or null
    nlohmann::ordered_json materials{};  ///< of sensitivity.json, or null
    std::vector<ResultPair> pairs{};
};

/// Reads all of them. Throws Error naming the file that is not
/// what it should be.
ResultFiles read_result_files(const RoomReport& report);

}  // namespace earshot::io
