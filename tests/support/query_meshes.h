// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include "support/meshes.h"
#include <string>
#include <vector>

namespace earshot::test {

/// A mesh with where it is and how large, for questions at its scale.
struct QueryMesh {
    std::string name;
    geometry::Mesh mesh;
    geometry::Vec3 centre{0.0};
    double size = 1.0;  ///< half the width of a cube that holds it
};

/// Copies of triangles, triangles that are segments or points, and triangles that share vertices.
inline geometry::Mesh degenerate_soup(std::uint64_t seed, std::size_t count) {
    geometry::Mesh mesh = triangle_soup(seed, count);
    for (std::size_t i = 0; i < count; ++i) {
        auto [a, b, c] = mesh.triangles[i];
        switch (i % 6) {
            case 0:
                mesh.triangles[i] = {a, b, b};
                break;
            case 1:
                mesh.triangles[i] = {c, c, c};
                break;
            case 2:  // collinear
                mesh.positions[c] =
                    mesh.positions[a] + 0.5 * (mesh.positions[b] - mesh.positions[a]);
                break;
            case 3:
                mesh.triangles.push_back({b, c, a});
                break;
            case 4:  // a needle
                mesh.positions[c] = mesh.positions[a] + 1e-13 * mesh.positions[c];
                break;
            default:
                mesh.triangles[i] = {a, b, (c + 5) % static_cast<std::uint32_t>(3 * count)};
        }
    }
    return mesh;
}

/// Meshes of every scale and kind; the last is empty.
inline std::vector<QueryMesh> query_meshes(std::uint64_t seed) {
    return {{.name = "soup", .mesh = triangle_soup(seed, 400), .size = 2.0},
            {.name = "degenerate soup", .mesh = degenerate_soup(seed, 300), .size = 2.0},
            {.name = "sphere", .mesh = sphere(3, 1.0, {1.0, 2.0, 3.0}), .centre = {1.0, 2.0, 3.0}},
            {.name = "cube", .mesh = cube(6, 0.5), .size = 0.5},
            {.name = "25 cm at 10 km",
             .mesh = sphere(3, 0.125, {7000.1, -7000.2, 300.3}),
             .centre = {7000.1, -7000.2, 300.3},
             .size = 0.125},
            {.name = "microscopic", .mesh = sphere(2, 1e-9, geometry::Vec3(0.0)), .size = 1e-9},
            {.name = "planetary",
             .mesh = sphere(2, 6e6, {6e6, 0.0, 0.0}),
             .centre = {6e6, 0.0, 0.0},
             .size = 6e6},
            {.name = "empty", .mesh = {}}};
}

/// A tree over a mesh, and one whose boxes were refitted from elsewhere.
inline std::vector<bvh::Tree> query_trees(const geometry::Mesh& mesh) {
    auto moved = mesh;
    for (geometry::Vec3& position : moved.positions) {
        position = {position.z, -position.x, 0.5 * position.y};
    }
    std::vector<bvh::Tree> trees = {
        bvh::Tree::build(bvh::triangle_boxes(mesh.view())),
        bvh::Tree::build(bvh::triangle_boxes(mesh.view()), {.max_leaf_size = 1}),
        bvh::Tree::build(bvh::triangle_boxes(moved.view()), {.max_leaf_size = 15})};
    trees.back().refit(bvh::triangle_boxes(mesh.view()));
    return trees;
}

/// A place near or in a mesh: anywhere, at a vertex, on an edge, in a triangle, far away.
inline geometry::Vec3 query_point(const QueryMesh& of, std::uint64_t seed, std::uint64_t i) {
    const geometry::Vec3 anywhere = of.centre + 1.5 * of.size * random_point(seed, i);
    if (of.mesh.triangles.empty()) {
        return anywhere;
    }
    const auto& [a, b, c] = of.mesh.triangles[random_bits(seed, 5, i) % of.mesh.triangles.size()];
    const auto& p = of.mesh.positions;
    switch (i % 8) {
        case 0:
            return p[a];
        case 1:
            return 0.5 * (p[a] + p[b]);
        case 2:
            return 0.25 * p[a] + 0.25 * p[b] + 0.5 * p[c];
        case 3:
            return of.centre + 1e4 * of.size * random_point(seed, i);
        case 4:
            return p[b] + 1e-9 * of.size * random_point(seed, i);
        case 5:  // over the middle of an edge
            return 0.5 * (p[b] + p[c]) + geometry::Vec3(0.0, of.size, 0.0);
        default:
            return anywhere;
    }
}

/// A ray between two such places, at times with an end or along an axis.
inline geometry::Ray query_ray(const QueryMesh& of, std::uint64_t seed, std::uint64_t i) {
    const geometry::Vec3 from = query_point(of, seed, 2 * i);
    geometry::Ray ray{from, query_point(of, seed, 2 * i + 1 + i % 5) - from};
    if (i % 7 == 0) {
        ray.direction = geometry::Vec3(0.0);
        ray.direction[static_cast<int>(i % 3)] = of.size;
    }
    if (i % 4 == 0) {
        ray.t_max = 2.0 * random(seed, 6, i);
    }
    return ray;
}

}  // namespace earshot::test
