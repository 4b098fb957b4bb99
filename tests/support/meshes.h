// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>

#include <cstdint>
#include <map>
#include <utility>

namespace earshot::test {

inline geometry::Vec3 random_point(std::uint64_t seed,
                                   std::uint64_t index,
                                   double low = -1.0,
                                   double high = 1.0) {
    return {random_between(seed, 0, index, low, high),
            random_between(seed, 1, index, low, high),
            random_between(seed, 2, index, low, high)};
}

/// Triangles of mixed sizes strewn over a cube of half-width 1.
inline geometry::Mesh triangle_soup(std::uint64_t seed, std::size_t count) {
    geometry::Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        const geometry::Vec3 centre = random_point(seed, 4 * i);
        const double size = random(seed, 3, i) < 0.05 ? 1.0 : 0.1;
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        for (std::size_t k = 1; k < 4; ++k) {
            mesh.positions.push_back(centre + size * random_point(seed, 4 * i + k));
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

/// A closed sphere of 8 * 4^levels triangles that share vertices, fronts outside.
inline geometry::Mesh sphere(int levels, double radius, const geometry::Vec3& centre) {
    geometry::Mesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {
        {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<geometry::VertexId, geometry::VertexId>, geometry::VertexId> middles;
        const auto middle = [&](geometry::VertexId a, geometry::VertexId b) {
            const auto [entry, is_new] = middles.try_emplace(
                std::minmax(a, b), static_cast<geometry::VertexId>(mesh.positions.size()));
            if (is_new) {
                mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
            }
            return entry->second;
        };
        std::vector<geometry::Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const auto ab = middle(a, b);
            const auto bc = middle(b, c);
            const auto ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (geometry::Vec3& position : mesh.positions) {
        position = centre + radius * position;
    }
    return mesh;
}

}  // namespace earshot::test
