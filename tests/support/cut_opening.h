// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/triangulate.h"
#include "earshot/propagation/scene.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace earshot::support {

/// A rectangle that was cut out of a triangle.
struct CutOpening {
    geometry::Vec3 centre{0.0};
    geometry::Vec3 along{0.0}, across{0.0};  ///< its sides, metres

    double area() const { return glm::length(along) * glm::length(across); }
};

/// Cuts a rectangle out of a random large triangle of a scene that does not move, in the middle of
/// which there is room before its front and nothing right behind its back. The frame keeps the
/// corners of the triangle, so that the only border is that of the rectangle. Nothing if no such
/// triangle holds the rectangle.
inline std::optional<CutOpening> cut_opening(propagation::Scene& scene,
                                             std::uint64_t seed,
                                             double length,
                                             double width) {
    using geometry::Vec3;
    geometry::Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    const bvh::DeformableBvh bvh(mesh.view());
    for (std::uint64_t attempt = 0; attempt < 4000; ++attempt) {
        const auto t = static_cast<geometry::TriangleId>(random_bits(seed, 0, attempt) %
                                                         mesh.triangles.size());
        const auto [a, b, c] = geometry::corners(mesh, t);
        const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
        const double root = std::sqrt(random(seed, 1, attempt));
        const double share = random(seed, 2, attempt);
        const Vec3 centre = a + root * (1.0 - share) * (b - a) + root * share * (c - a);
        const Vec3 along = length * glm::normalize(b - a);
        const Vec3 across = width * glm::cross(normal, glm::normalize(b - a));
        const auto at = [&](double u, double v) { return centre + u * along + v * across; };
        const std::vector<Vec3> hole{at(-0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0.5, -0.5)};
        // With a margin: every corner lies well inside the triangle.
        const auto lies_inside = [&](const Vec3& p) {
            const auto height = [&](const Vec3& from, const Vec3& to) {
                return glm::dot(glm::cross(normal, glm::normalize(to - from)), p - from);
            };
            return height(a, b) > 0.02 && height(b, c) > 0.02 && height(c, a) > 0.02;
        };
        bool fits = true;
        for (const Vec3& corner : hole) {
            fits = fits && lies_inside(corner);
        }
        const auto is_clear = [&](const Vec3& p, const Vec3& direction, double distance) {
            const auto hit = bvh.view().closest_hit({p + 1e-6 * direction, direction});
            return !hit || hit->t > distance;
        };
        for (std::size_t i = 0; fits && i < hole.size(); ++i) {
            fits = is_clear(hole[i], normal, 0.3) && is_clear(hole[i], -normal, 0.05);
        }
        if (!fits) {
            continue;
        }
        std::vector<glm::dvec2> plane;
        std::vector<Vec3> corners{a, b, c};
        corners.insert(corners.end(), hole.begin(), hole.end());
        for (const Vec3& p : corners) {
            plane.emplace_back(glm::dot(p - a, glm::normalize(along)),
                               glm::dot(p - a, glm::normalize(across)));
        }
        const auto pieces = geometry::triangulate(
            plane, {{0, 1, 2}, {3, 4, 5, 6}}, geometry::EarOrder::shortest_diagonal);
        const geometry::Triangle old = mesh.triangles[t];
        std::vector<geometry::VertexId> vertices(old.begin(), old.end());
        for (const Vec3& p : hole) {
            vertices.push_back(static_cast<geometry::VertexId>(mesh.positions.size()));
            mesh.positions.push_back(p);
        }
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const geometry::Triangle piece{
                vertices[pieces[i][0]], vertices[pieces[i][1]], vertices[pieces[i][2]]};
            if (i == 0) {
                mesh.triangles[t] = piece;
            } else {
                mesh.triangles.push_back(piece);
                scene.material_of_triangle.push_back(scene.material_of_triangle[t]);
            }
        }
        // Sources and listeners stay where their nodes hold them.
        for (auto* emitters : {&scene.sources, &scene.listeners}) {
            for (propagation::Emitter& emitter : *emitters) {
                emitter.position = scene.position_at(emitter, 0.0);
                emitter.node = -1;
            }
        }
        scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
        return CutOpening{centre, along, across};
    }
    return std::nullopt;
}

}  // namespace earshot::support
