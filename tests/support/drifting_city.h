// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/geometry/mesh.h"

#include <cmath>
#include <cstdint>
#include <utility>

namespace earshot::test {

/// A city of 8 x 8 blocks of 20 m, each a house on a patch of ground, and 400 boxes of 0.2 to 0.7 m
/// in its streets, which drift: up to 0.5 m a step along each horizontal axis and 0.1 m up or
/// down, each in its own direction. 19,136 triangles.
class DriftingCity {
public:
    DriftingCity() {
        for (int i = 0; i < 8; ++i) {
            for (int k = 0; k < 8; ++k) {
                const geometry::Vec3 corner(20.0 * i, 0.0, 20.0 * k);
                const double height = 5.0 + 25.0 * dice();
                add_box(corner + geometry::Vec3(3.0, 0.0, 3.0), {14.0, height, 14.0}, 4);
                add_quad(corner, {20.0, 0.0, 0.0}, {0.0, 0.0, 20.0}, 4);
            }
        }
        first_moving_ = rest_.positions.size();
        for (int box = 0; box < 400; ++box) {
            const double along = 160.0 * dice();
            const double across = 20.0 * std::floor(8.0 * dice()) + (dice() < 0.5 ? 1.0 : 18.0);
            const double size = 0.2 + 0.5 * dice();
            add_box(dice() < 0.5 ? geometry::Vec3(along, 0.0, across)
                                 : geometry::Vec3(across, 0.0, along),
                    geometry::Vec3(size),
                    1);
        }
    }

    geometry::Mesh at(double step) const {
        constexpr std::size_t kVerticesOfABox = 24;
        geometry::Mesh mesh = rest_;
        for (std::size_t i = first_moving_; i < mesh.positions.size(); ++i) {
            const std::uint64_t box = (i - first_moving_) / kVerticesOfABox;
            mesh.positions[i] += step * geometry::Vec3(random_between(8, 0, box, -0.5, 0.5),
                                                       random_between(8, 1, box, -0.1, 0.1),
                                                       random_between(8, 2, box, -0.5, 0.5));
        }
        return mesh;
    }

private:
    double dice() { return random(7, 0, dice_++); }

    /// A parallelogram of n x n quads.
    void add_quad(const geometry::Vec3& corner,
                  const geometry::Vec3& u,
                  const geometry::Vec3& v,
                  int n) {
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < n; ++k) {
                const auto first = static_cast<geometry::VertexId>(rest_.positions.size());
                for (const auto& [a, b] :
                     {std::pair{i, k}, {i + 1, k}, {i + 1, k + 1}, {i, k + 1}}) {
                    rest_.positions.push_back(corner + (1.0 * a / n) * u + (1.0 * b / n) * v);
                }
                rest_.triangles.push_back({first, first + 1, first + 2});
                rest_.triangles.push_back({first, first + 2, first + 3});
            }
        }
    }

    void add_box(const geometry::Vec3& corner, const geometry::Vec3& size, int n) {
        for (int axis = 0; axis < 3; ++axis) {
            geometry::Vec3 across(0.0), u(0.0), v(0.0);
            across[axis] = size[axis];
            u[(axis + 1) % 3] = size[(axis + 1) % 3];
            v[(axis + 2) % 3] = size[(axis + 2) % 3];
            add_quad(corner, u, v, n);
            add_quad(corner + across, u, v, n);
        }
    }

    geometry::Mesh rest_;
    std::size_t first_moving_ = 0;
    std::uint64_t dice_ = 0;
};

}  // namespace earshot::test
