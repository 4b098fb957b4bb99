// SPDX-License-Identifier: MIT
#include "earshot/io/points.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/text.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace earshot::io {

namespace {

std::optional<geometry::Vec3> point_of(const std::vector<std::string_view>& cells) {
    if (cells.size() != 3) {
        return std::nullopt;
    }
    geometry::Vec3 point;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto number = to_number(cells[k]);
        if (!number || !(std::fabs(*number) <= kMaxCoordinate)) {
            return std::nullopt;
        }
        point[static_cast<int>(k)] = *number;
    }
    return point;
}

}  // namespace

std::vector<geometry::Vec3> read_points(const std::filesystem::path& file) {
    const std::string text = read_whole_file(file);
    std::vector<geometry::Vec3> points;
    Lines lines(text);
    while (const auto line = lines.next()) {
        const auto cells = cells_of(*line);
        if (trimmed(*line).empty()) {
            continue;
        }
        const bool is_header = lines.number() == 1 &&
                               std::none_of(cells.begin(), cells.end(), [](std::string_view cell) {
                                   return to_number(cell);
                               });
        if (is_header) {
            continue;
        }
        const auto point = point_of(cells);
        if (!point) {
            throw Error(file.string(),
                        lines.name() + " is not a point",
                        "give X,Y,Z in metres on each line, at most 1e12");
        }
        points.push_back(*point);
    }
    if (points.empty()) {
        throw Error(file.string(), "holds no points", "give X,Y,Z in metres on each line");
    }
    return points;
}

}  // namespace earshot::io
