// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::scenes {

/// A point of a plane in ticks of 0.1 mm. Whole numbers, because then "on one line" and "left of"
/// are decided exactly.
struct GridPoint {
    std::int64_t u = 0;
    std::int64_t v = 0;
    friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

inline constexpr double kTicksPerMetre = 10000.0;

/// The nearest tick.
std::int64_t ticks(double metres);

/// Twice the signed area inside a loop: positive if it runs counter-clockwise.
std::int64_t doubled_area(const std::vector<GridPoint>& loop);

/// geometry::triangulate() of loops on the grid, the ear with the shortest diagonal first.
/// Precondition: there are at least three corners that do not lie on one line.
std::vector<std::array<GridPoint, 3>> triangulate(const std::vector<std::vector<GridPoint>>& loops);

}  // namespace earshot::scenes
