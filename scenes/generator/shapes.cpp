// SPDX-License-Identifier: MIT
#include "earshot/scenes/shapes.h"

#include "earshot/scenes/tick_grid.h"

#include <algorithm>

namespace earshot::scenes {

Faces prism(const std::vector<Vec2>& profile,
            double length,
            const Frame& frame,
            std::size_t material) {
    const auto at = [&](double u, double v, double w) {
        return frame.origin + frame.u * u + frame.v * v + frame.w * w;
    };
    std::vector<GridPoint> loop(profile.size());
    std::transform(profile.begin(), profile.end(), loop.begin(), [](const Vec2& corner) {
        return GridPoint{ticks(corner.u), ticks(corner.v)};
    });
    const auto on_grid = [&](const GridPoint& point, double w) {
        return at(static_cast<double>(point.u) / kTicksPerMetre,
                  static_cast<double>(point.v) / kTicksPerMetre,
                  w);
    };

    Faces faces;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const GridPoint& a = loop[i];
        const GridPoint& b = loop[(i + 1) % loop.size()];
        faces.push_back({{on_grid(a, 0.0), on_grid(b, 0.0), on_grid(b, length), on_grid(a, length)},
                         4,
                         material});
    }
    for (const auto& [a, b, c] : triangulate({loop})) {
        faces.push_back({{on_grid(c, 0.0), on_grid(b, 0.0), on_grid(a, 0.0)}, 3, material});
        faces.push_back(
            {{on_grid(a, length), on_grid(b, length), on_grid(c, length)}, 3, material});
    }
    return faces;
}

Faces box(const Vec3& low, const Vec3& high, std::size_t material) {
    const Vec3 size = high - low;
    const std::vector<Vec2> profile = {{0.0, 0.0}, {size.x, 0.0}, {size.x, size.y}, {0.0, size.y}};
    return prism(profile, size.z, {.origin = low}, material);
}

void append(Faces& faces, const Faces& more) {
    faces.insert(faces.end(), more.begin(), more.end());
}

}  // namespace earshot::scenes
