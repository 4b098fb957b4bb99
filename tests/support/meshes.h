// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>

#include <array>
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

/// A closed cube around the origin, each face a grid of `steps` x `steps` squares cut in two. Faces
/// share vertices along their borders.
inline geometry::Mesh cube(int steps, double half_width) {
    geometry::Mesh mesh;
    std::map<std::array<int, 3>, geometry::VertexId> known;
    const auto vertex = [&](std::array<int, 3> place) {
        const auto [entry, is_new] =
            known.try_emplace(place, static_cast<geometry::VertexId>(mesh.positions.size()));
        if (is_new) {
            const geometry::Vec3 step(place[0], place[1], place[2]);
            mesh.positions.push_back(half_width * (2.0 * step / static_cast<double>(steps) - 1.0));
        }
        return entry->second;
    };
    for (std::size_t face = 0; face < 6; ++face) {
        const std::size_t axis = face / 2;
        for (int i = 0; i < steps; ++i) {
            for (int j = 0; j < steps; ++j) {
                const auto corner = [&](int di, int dj) {
                    std::array<int, 3> place{};
                    place[axis] = face % 2 == 0 ? 0 : steps;
                    place[(axis + 1) % 3] = i + di;
                    place[(axis + 2) % 3] = j + dj;
                    return vertex(place);
                };
                mesh.triangles.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
                mesh.triangles.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
            }
        }
    }
    return mesh;
}

}  // namespace earshot::test
