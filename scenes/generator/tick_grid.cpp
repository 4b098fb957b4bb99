// SPDX-License-Identifier: MIT
#include "earshot/scenes/tick_grid.h"

#include "earshot/geometry/triangulate.h"

#include <cmath>
#include <utility>

namespace earshot::scenes {

std::int64_t ticks(double metres) {
    return std::llround(metres * kTicksPerMetre);
}

std::int64_t doubled_area(const std::vector<GridPoint>& loop) {
    std::int64_t area = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const GridPoint& next = loop[(i + 1) % loop.size()];
        area += loop[i].u * next.v - loop[i].v * next.u;
    }
    return area;
}

std::vector<std::array<GridPoint, 3>> triangulate(
    const std::vector<std::vector<GridPoint>>& loops) {
    // Ticks, and squares of distances in ticks, are exact as doubles up to 2^53.
    std::vector<GridPoint> corners;
    std::vector<glm::dvec2> points;
    std::vector<geometry::IndexLoop> indices;
    for (const std::vector<GridPoint>& loop : loops) {
        geometry::IndexLoop& numbered = indices.emplace_back();
        for (const GridPoint& corner : loop) {
            numbered.push_back(corners.size());
            corners.push_back(corner);
            points.emplace_back(static_cast<double>(corner.u), static_cast<double>(corner.v));
        }
    }
    std::vector<std::array<GridPoint, 3>> triangles;
    for (const auto& [a, b, c] :
         geometry::triangulate(points, std::move(indices), geometry::EarOrder::shortest_diagonal)) {
        triangles.push_back({corners[a], corners[b], corners[c]});
    }
    return triangles;
}

}  // namespace earshot::scenes
