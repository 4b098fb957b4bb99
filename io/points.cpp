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

/// Calls row(cells, position) for each line of `columns` cells whose last three are a position.
template <class Row>
void for_each_row(const std::filesystem::path& file, std::size_t columns, const Row& row) {
    const std::string text = read_whole_file(file);
    const std::string form = columns == 3 ? "X,Y,Z" : "NAME,X,Y,Z";
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
        if (!position || cells.front().empty()) {
            throw Error(file.string(),
                        lines.name() + " is not a point",
                        "give " + form + " on each line, at most 1e12");
        }
        row(cells, *position);
        is_empty = false;
    }
    if (is_empty) {
        throw Error(file.string(), "holds no points", "give " + form + " on each line");
    }
}

}  // namespace

std::vector<geometry::Vec3> read_points(const std::filesystem::path& file) {
    std::vector<geometry::Vec3> points;
    for_each_row(
        file, 3, [&](const Cells&, const geometry::Vec3& position) { points.push_back(position); });
    return points;
}

std::vector<NamedPosition> read_named_points(const std::filesystem::path& file) {
    std::vector<NamedPosition> points;
    for_each_row(file, 4, [&](const Cells& cells, const geometry::Vec3& position) {
        points.push_back({std::string(cells.front()), position});
    });
    return points;
}

}  // namespace earshot::io
