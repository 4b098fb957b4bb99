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

/// Twice the signed area of a triangle: positive if a, b, c turn counter-clockwise.
std::int64_t doubled_area(const GridPoint& a, const GridPoint& b, const GridPoint& c);

/// Twice the signed area inside a loop.
std::int64_t doubled_area(const std::vector<GridPoint>& loop);

/// Triangles (counter-clockwise) that fill a polygon: loops[0] is its outline, counter-clockwise,
/// the others are its holes, clockwise. No loop crosses or touches another. Every corner is used,
/// no other point is made: neighbours that share corners fit without T-junctions.
/// Precondition: there are at least three corners that do not lie on one line.
std::vector<std::array<GridPoint, 3>> triangulate(std::vector<std::vector<GridPoint>> loops);

}  // namespace earshot::scenes
