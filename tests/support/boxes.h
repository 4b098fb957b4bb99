// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <array>
#include <utility>

namespace earshot::support {

/// Appends a box; fronts inside, or outside.
inline void add_box(geometry::Mesh& mesh,
                    const geometry::Vec3& lower,
                    const geometry::Vec3& upper,
                    bool inward) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (unsigned corner = 0; corner < 8; ++corner) {
        mesh.positions.emplace_back((corner & 1U) != 0 ? upper.x : lower.x,
                                    (corner & 2U) != 0 ? upper.y : lower.y,
                                    (corner & 4U) != 0 ? upper.z : lower.z);
    }
    constexpr std::array<std::array<unsigned, 4>, 6> kSides{
        {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
    for (const auto& side : kSides) {
        for (const unsigned k : {1U, 2U}) {
            geometry::Triangle triangle{first + side[0], first + side[k], first + side[k + 1]};
            if (!inward) {
                std::swap(triangle[1], triangle[2]);
            }
            mesh.triangles.push_back(triangle);
        }
    }
}

}  // namespace earshot::support
