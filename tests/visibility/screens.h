// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"

#include <algorithm>
#include <array>
#include <vector>

namespace earshot::test {

/// One square of a screen.
struct Tile {
    std::array<geometry::TriangleId, 2> triangles{};
    double left = 0.0, right = 0.0;  ///< along x
};

/// Adds an upright rectangle between two opposite corners of one z, cut into columns and rows of
/// tiles of two triangles each that share vertices. Row after row.
inline std::vector<Tile> add_screen(geometry::Mesh& mesh,
                                    const geometry::Vec3& lower,
                                    const geometry::Vec3& upper,
                                    unsigned columns,
                                    unsigned rows = 1) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    const auto x = [&](unsigned i) { return lower.x + (upper.x - lower.x) * i / columns; };
    for (unsigned row = 0; row <= rows; ++row) {
        for (unsigned column = 0; column <= columns; ++column) {
            mesh.positions.emplace_back(
                x(column), lower.y + (upper.y - lower.y) * row / rows, lower.z);
        }
    }
    std::vector<Tile> tiles;
    for (unsigned row = 0; row < rows; ++row) {
        for (unsigned column = 0; column < columns; ++column) {
            const geometry::VertexId corner = first + row * (columns + 1) + column;
            const auto id = static_cast<geometry::TriangleId>(mesh.triangles.size());
            mesh.triangles.push_back({corner, corner + 1, corner + columns + 2});
            mesh.triangles.push_back({corner, corner + columns + 2, corner + columns + 1});
            tiles.push_back({{id, id + 1}, x(column), x(column + 1)});
        }
    }
    return tiles;
}

inline bvh::WideTree tree_of(const geometry::Mesh& mesh,
                             bvh::Builder builder = bvh::Builder::binned_sah) {
    const auto boxes = bvh::triangle_boxes(mesh.view());
    return bvh::WideTree::build(bvh::Tree::build(boxes, {.builder = builder}), mesh.view());
}

}  // namespace earshot::test
