// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/geometry/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace earshot::support {

// Meshes that move over a time of 0 ... 1, of any fineness, like those that collision detection has
// been measured with: cloth that falls on a ball, a skirt of layers, balls that fly about.

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

/// A grid of quadrilaterals as triangles; wraps round its first direction if asked.
inline std::vector<Triangle> grid(int columns, int rows, bool wraps) {
    std::vector<Triangle> triangles;
    const int per_row = wraps ? columns : columns + 1;
    const auto at = [&](int i, int k) {
        return static_cast<VertexId>(k * per_row + (wraps ? i % columns : i));
    };
    for (int k = 0; k < rows; ++k) {
        for (int i = 0; i < columns; ++i) {
            triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return triangles;
}

struct Part {
    std::vector<Triangle> triangles;
    std::function<std::vector<Vec3>(double)> at;  // positions at a time, 0 ... 1
};

/// Falls from above a ball and lies on it in folds that turn.
inline Part cloth(int side) {
    return {grid(side, side, false), [side](double t) {
                std::vector<Vec3> points;
                for (int k = 0; k <= side; ++k) {
                    for (int i = 0; i <= side; ++i) {
                        const double x = 2.0 * i / side - 1.0;
                        const double z = 2.0 * k / side - 1.0;
                        const double r = std::sqrt(x * x + z * z);
                        const double fold =
                            0.12 * t * r * std::cos(12.0 * std::atan2(z, x) + 3.0 * t);
                        const double pull = 1.0 - 0.45 * t * std::min(1.0, r);
                        const double height = 0.32 - t * std::max(0.0, r - 0.25) * 0.9 + fold;
                        points.emplace_back(x * pull, height, z * pull);
                    }
                }
                return points;
            }};
}

inline Part ball(const Vec3& from, const Vec3& velocity, double radius, int columns, int rows) {
    return {grid(columns, rows, true), [=](double t) {
                std::vector<Vec3> points;
                for (int k = 0; k <= rows; ++k) {
                    const double polar = 3.14159265358979 * (0.01 + 0.98 * k / rows);
                    for (int i = 0; i < columns; ++i) {
                        const double turn = 6.28318530717959 * i / columns;
                        points.push_back(from + t * velocity +
                                         radius * Vec3(std::sin(polar) * std::cos(turn),
                                                       std::cos(polar),
                                                       std::sin(polar) * std::sin(turn)));
                    }
                }
                return points;
            }};
}

/// A layer of a skirt, 4 mm from the next, with waves that travel.
inline Part layer(int index, int columns, int rows) {
    return {grid(columns, rows, true), [=](double t) {
                std::vector<Vec3> points;
                for (int k = 0; k <= rows; ++k) {
                    for (int i = 0; i < columns; ++i) {
                        const double turn = 6.28318530717959 * i / columns;
                        const double down = k / double(rows);
                        const double r = 0.2 + 0.004 * index + 0.5 * down +
                                         0.05 * down * std::sin(9.0 * turn + 6.0 * t);
                        points.emplace_back(r * std::cos(turn + 0.2 * t * down),
                                            -down + 0.02 * std::sin(5.0 * turn - 4.0 * t),
                                            r * std::sin(turn + 0.2 * t * down));
                    }
                }
                return points;
            }};
}

/// A cloth of 2 side^2 triangles and a ball that it slides over.
inline std::vector<Part> cloth_on_ball(int side) {
    return {cloth(side), ball({0, 0, 0}, {0, 0, 0}, 0.3195, side / 4, side / 8)};
}

/// Ten layers of 2 columns * rows triangles.
inline std::vector<Part> skirt(int columns, int rows) {
    std::vector<Part> layers;
    for (int i = 0; i < 10; ++i) {
        layers.push_back(layer(i, columns, rows));
    }
    return layers;
}

inline std::vector<Part> flying_balls(std::uint64_t count, int columns, int rows) {
    std::vector<Part> balls;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto dice = [&](std::uint64_t k) { return random_between(1, k, i, -1, 1); };
        balls.push_back(
            ball({dice(0), dice(1), dice(2)}, {dice(3), dice(4), dice(5)}, 0.12, columns, rows));
    }
    return balls;
}

}  // namespace earshot::support
