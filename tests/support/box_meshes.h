// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "support/dice.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace earshot::support {

/// A turn about a random axis.
inline glm::dmat3 random_turn(Dice& dice) {
    geometry::Vec3 axes[2];
    for (geometry::Vec3& axis : axes) {
        axis = {dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(0.1, 1.0)};
    }
    const geometry::Vec3 x = glm::normalize(axes[0]);
    const geometry::Vec3 y = glm::normalize(axes[1] - glm::dot(axes[1], x) * x);
    return {x, y, glm::cross(x, y)};
}

/// How a box is cut into triangles, and where it stands.
struct BoxShape {
    geometry::Vec3 size{1.0};
    geometry::Vec3 corner{0.0};  ///< after the turn
    glm::dmat3 turn{1.0};
    std::array<std::vector<double>, 3> cuts{};  ///< of the edges along each axis, between 0 and 1
    bool rounds_to_float = false;
    bool turns_walls_outside = false;  ///< every other one
};

/// The room's point with the given shares of its edges.
inline geometry::Vec3 point_in(const BoxShape& shape, const geometry::Vec3& share) {
    return shape.corner + shape.turn * (share * shape.size);
}

/// Every wall is a grid of rectangles, cut along one diagonal or the other.
inline geometry::Mesh box_mesh(const BoxShape& shape, Dice& dice) {
    geometry::Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const auto stations = [&](int k) {
            std::vector<double> all = shape.cuts[static_cast<std::size_t>(k)];
            all.insert(all.end(), {0.0, 1.0});
            std::sort(all.begin(), all.end());
            return all;
        };
        const std::vector<double> along_u = stations(u), along_v = stations(v);
        for (int side = 0; side < 2; ++side) {
            const bool reversed = (side == 1) != (shape.turns_walls_outside && axis == 1);
            const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
            for (const double b : along_v) {
                for (const double a : along_u) {
                    geometry::Vec3 share(0.0);
                    share[axis] = side;
                    share[u] = a;
                    share[v] = b;
                    geometry::Vec3 point = point_in(shape, share);
                    for (int k = 0; k < 3 && shape.rounds_to_float; ++k) {
                        point[k] = static_cast<double>(static_cast<float>(point[k]));
                    }
                    mesh.positions.push_back(point);
                }
            }
            const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
                const auto id = [&](std::size_t i) {
                    return first + static_cast<geometry::VertexId>(i);
                };
                mesh.triangles.push_back(reversed ? geometry::Triangle{id(a), id(c), id(b)}
                                                  : geometry::Triangle{id(a), id(b), id(c)});
            };
            const std::size_t width = along_u.size();
            for (std::size_t j = 0; j + 1 < along_v.size(); ++j) {
                for (std::size_t i = 0; i + 1 < width; ++i) {
                    const std::size_t corner = j * width + i;
                    if (dice.chance(0.5)) {
                        add(corner, corner + 1, corner + width + 1);
                        add(corner, corner + width + 1, corner + width);
                    } else {
                        add(corner, corner + 1, corner + width);
                        add(corner + 1, corner + width + 1, corner + width);
                    }
                }
            }
        }
    }
    return mesh;
}

/// A box of a room's size: every second one turned, every third one stored in single precision.
inline BoxShape random_box(std::uint64_t seed, Dice& dice) {
    BoxShape shape;
    shape.size = {dice.between(2.0, 12.0), dice.between(2.0, 6.0), dice.between(2.0, 12.0)};
    shape.corner = {dice.between(-5.0, 5.0), dice.between(-5.0, 5.0), dice.between(-5.0, 5.0)};
    if (seed % 2 == 1) {
        shape.turn = random_turn(dice);
    }
    shape.rounds_to_float = seed % 3 == 1;
    shape.turns_walls_outside = seed % 5 == 1;
    for (std::vector<double>& cuts : shape.cuts) {
        for (int i = dice.below(4); i > 0; --i) {
            cuts.push_back(dice.between(0.02, 0.98));
        }
    }
    return shape;
}

}  // namespace earshot::support
