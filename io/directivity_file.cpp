// SPDX-License-Identifier: MIT
#include "earshot/io/directivity_file.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/text.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace earshot::io {

namespace {

constexpr const char* kRemedy = "give azimuth,elevation,125,250,... and a line per direction";

[[noreturn]] void fail(const std::filesystem::path& file, const Lines& lines, const char* what) {
    throw Error(file.string() + ": " + lines.name(), what, kRemedy);
}

std::vector<double> numbers_of(const std::vector<std::string_view>& cells,
                               std::size_t from,
                               const std::filesystem::path& file,
                               const Lines& lines) {
    std::vector<double> numbers;
    for (std::size_t i = from; i < cells.size(); ++i) {
        const auto value = to_number(cells[i]);
        if (!value || !std::isfinite(*value)) {
            fail(file, lines, "contains a value that is not a number");
        }
        numbers.push_back(*value);
    }
    return numbers;
}

struct Rows {
    std::vector<double> frequencies_hz;
    std::map<std::pair<double, double>, std::vector<double>> levels;  // elevation, azimuth
};

Rows read_rows(const std::filesystem::path& file) {
    const std::string text = read_whole_file(file);
    Rows rows;
    Lines lines(decoded_text(text, file.string()));
    while (const auto line = lines.next()) {
        if (trimmed(*line).empty()) {
            continue;
        }
        const auto cells = cells_of(*line);
        if (rows.frequencies_hz.empty()) {
            if (cells.size() < 3 || cells[0] != "azimuth" || cells[1] != "elevation") {
                fail(file, lines, "does not begin with azimuth,elevation and a frequency");
            }
            rows.frequencies_hz = numbers_of(cells, 2, file, lines);
            continue;
        }
        const std::vector<double> numbers = numbers_of(cells, 0, file, lines);
        if (numbers.size() != rows.frequencies_hz.size() + 2) {
            fail(file, lines, "differs from the first line in its number of values");
        }
        const bool is_new =
            rows.levels
                .try_emplace({numbers[1], numbers[0]},
                             std::vector<double>(numbers.begin() + 2, numbers.end()))
                .second;
        if (!is_new) {
            fail(file, lines, "repeats a direction");
        }
    }
    return rows;
}

}  // namespace

propagation::Directivity read_directivity(const std::filesystem::path& file) {
    const Rows rows = read_rows(file);
    std::set<double> azimuths, elevations;
    for (const auto& [direction, levels] : rows.levels) {
        elevations.insert(direction.first);
        azimuths.insert(direction.second);
    }
    if (rows.levels.empty() || rows.levels.size() != azimuths.size() * elevations.size()) {
        throw Error(file.string(), "does not list every azimuth at every elevation", kRemedy);
    }
    propagation::DirectivityTable table{.frequencies_hz = rows.frequencies_hz,
                                        .azimuths = {azimuths.begin(), azimuths.end()},
                                        .elevations = {elevations.begin(), elevations.end()},
                                        .levels_db = {}};
    for (std::size_t frequency = 0; frequency < rows.frequencies_hz.size(); ++frequency) {
        for (const auto& [direction, levels] : rows.levels) {
            table.levels_db.push_back(levels[frequency]);
        }
    }
    try {
        return propagation::Directivity::tabulated(std::move(table));
    } catch (const Error& error) {
        throw Error(file.string(), error.line(), "");
    }
}

propagation::Directivity directivity_named(const std::string& name,
                                           const std::filesystem::path& folder,
                                           const std::string& subject) {
    if (const auto pattern = propagation::Directivity::named(name)) {
        return *pattern;
    }
    const std::filesystem::path file = name;
    if (file.extension() == ".csv") {
        return read_directivity(folder / file);
    }
    throw Error(subject,
                "there is no directivity \"" + name + "\"",
                "use omni, subcardioid, cardioid, supercardioid, hypercardioid, figure-of-eight "
                "or the name of a .csv file");
}

}  // namespace earshot::io
