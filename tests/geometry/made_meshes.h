// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace earshot::geometry {

/// Adds the parallelogram origin + [0, 1] u + [0, 1] v as n x m cells of two triangles, its front
/// where u x v points. Neighbouring parallelograms with equal divisions share positions exactly if
/// their corners are the same.
inline void add_plate(Mesh& mesh, const Vec3& origin, const Vec3& u, const Vec3& v, int n, int m) {
    const auto first = static_cast<VertexId>(mesh.positions.size());
    for (int j = 0; j <= m; ++j) {
        for (int i = 0; i <= n; ++i) {
            mesh.positions.push_back(origin + u * (static_cast<double>(i) / n) +
                                     v * (static_cast<double>(j) / m));
        }
    }
    const auto width = static_cast<VertexId>(n + 1);
    for (VertexId j = 0; j < static_cast<VertexId>(m); ++j) {
        for (VertexId i = 0; i < static_cast<VertexId>(n); ++i) {
            const VertexId a = first + j * width + i;
            mesh.triangles.push_back({a, a + 1, a + width + 1});
            mesh.triangles.push_back({a, a + width + 1, a + width});
        }
    }
}

/// A box from 0 to `size`, its fronts inside, n x n cells per side: 12 n^2 triangles. Sizes that
/// are short binary fractions times n give positions that weld without rounding.
inline Mesh box_mesh(const Vec3& size, int n) {
    Mesh mesh;
    const Vec3 x(size.x, 0.0, 0.0);
    const Vec3 y(0.0, size.y, 0.0);
    const Vec3 z(0.0, 0.0, size.z);
    const Vec3 o(0.0);
    add_plate(mesh, o, x, y, n, n);
    add_plate(mesh, o, y, z, n, n);
    add_plate(mesh, o, z, x, n, n);
    add_plate(mesh, z, y, x, n, n);
    add_plate(mesh, x, z, y, n, n);
    add_plate(mesh, y, x, z, n, n);
    return mesh;
}

/// Turned, moved and stored as floats, as in a file.
inline Mesh as_stored(Mesh mesh, const glm::dmat3& turn, const Vec3& shift) {
    for (Vec3& p : mesh.positions) {
        const Vec3 moved = turn * p + shift;
        for (int axis = 0; axis < 3; ++axis) {
            p[axis] = static_cast<double>(static_cast<float>(moved[axis]));
        }
    }
    return mesh;
}

/// The same triangles in another order, each starting at another corner. order[i] is where
/// triangle i of the result comes from.
inline Mesh shuffled(const Mesh& mesh, std::uint64_t seed, std::vector<TriangleId>& order) {
    order.resize(mesh.triangles.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = static_cast<TriangleId>(i);
    }
    for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[random_bits(seed, 0, i) % i]);
    }
    Mesh result{mesh.positions, {}};
    for (const TriangleId source : order) {
        Triangle triangle = mesh.triangles[source];
        const auto turn = static_cast<std::ptrdiff_t>(random_bits(seed, 1, source) % 3);
        std::rotate(triangle.begin(), triangle.begin() + turn, triangle.end());
        result.triangles.push_back(triangle);
    }
    return result;
}

}  // namespace earshot::geometry
