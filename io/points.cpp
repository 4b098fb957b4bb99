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

using Cells = std::vector<std::string_view>;

/// The last three cells of a row.
std::optional<geometry::Vec3> position_of(const Cells& cells) {
    geometry::Vec3 point;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto number = to_number(cells[cells.size() - 3 + k]);
        if (!number || !(std::fabs(*number) <= kMaxCoordinate)) {
            return std::nullopt;
        }
        point[static_cast<int>(k)] = *number;
    }
    return point;
}

/// Calls row(cells, position) for each line of as many cells as `form` has, whose last three are a
/// position. A row that returns false is not of the form.
template <class Row>
void for_each_row(const std::filesystem::path& file, const std::string& form, const Row& row) {
    const std::string text = read_whole_file(file);
    const std::size_t columns = cells_of(form).size();
    Lines lines(decoded_text(text, file.string()));
    bool is_empty = true;
    while (const auto line = lines.next()) {
        const Cells cells = cells_of(*line);
        if (trimmed(*line).empty()) {
            continue;
        }
        const bool is_header =
            lines.number() == 1 && std::none_of(cells.begin(), cells.end(), to_number);
        if (is_header) {
            continue;
        }
        const auto position = cells.size() == columns ? position_of(cells) : std::nullopt;
        if (!position || cells.front().empty() || !row(cells, *position)) {
            throw Error(file.string(),
                        lines.name() + " is not a point",
                        "give " + form + " on each line, at most 1e12");
        }
        is_empty = false;
    }
    if (is_empty) {
        throw Error(file.string(), "holds no points", "give " + form + " on each line");
    }
}

}  // namespace

std::vector<geometry::Vec3> read_points(const std::filesystem::path& file) {
    std::vector<geometry::Vec3> points;
    for_each_row(file, "X,Y,Z", [&](const Cells&, const geometry::Vec3& position) {
        points.push_back(position);
        return true;
    });
    return points;
}

std::vector<NamedPosition> read_named_points(const std::filesystem::path& file) {
    std::vector<NamedPosition> points;
    for_each_row(file, "NAME,X,Y,Z", [&](const Cells& cells, const geometry::Vec3& position) {
        points.push_back({std::string(cells.front()), position});
        return true;
    });
    return points;
}

std::vector<propagation::TrajectoryKey> read_trajectory(const std::filesystem::path& file) {
    std::vector<propagation::TrajectoryKey> keys;
    for_each_row(file, "TIME,X,Y,Z", [&](const Cells& cells, const geometry::Vec3& position) {
        const auto time = to_number(cells.front());
        keys.push_back({time.value_or(0.0), position});
        return time && std::isfinite(*time);
    });
    return keys;
}

}  // namespace earshot::io
