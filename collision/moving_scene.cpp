// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/moving_scene.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

namespace {

void require_finite(std::uint32_t mesh, std::span<const Vec3> positions) {
    const auto is_finite = [](const Vec3& position) { return geometry::is_finite(position); };
    if (!std::all_of(positions.begin(), positions.end(), is_finite)) {
        throw Error(
            "mesh " + std::to_string(mesh), "a position is not finite", "check the positions");
    }
}

/// Returns whether any is other than before, to the bit: the sign of a zero may show in contacts.
bool assign(std::span<const Vec3> positions, std::span<Vec3> to) {
    bool differs = false;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Vec3 position = geometry::without_tiny_coordinates(positions[i]);
        differs = differs || std::memcmp(&position, &to[i], sizeof(Vec3)) != 0;
        to[i] = position;
    }
    return differs;
}

}  // namespace

void MovingScene::add(std::span<const Triangle> mesh, std::size_t vertices) {
    for (const Triangle& triangle : mesh) {
        for (const VertexId vertex : triangle) {
            if (vertex >= vertices) {
                throw Error("mesh " + std::to_string(meshes()),
                            "a triangle names vertex " + std::to_string(vertex) + " of " +
                                std::to_string(vertices),
                            "check the indices");
            }
        }
    }
    const VertexId first = first_vertex.back();
    for (const Triangle& triangle : mesh) {
        triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    }
    mesh_of_triangle.resize(triangles.size(), meshes());
    first_vertex.push_back(first + static_cast<VertexId>(vertices));
    first_triangle.push_back(triangles.size());
    begin.resize(first_vertex.back(), Vec3(0.0));
    end.resize(first_vertex.back(), Vec3(0.0));
    deviation.resize(first_vertex.back(), 0.0);
    screws.resize(meshes());
    revisions.resize(meshes(), 1);
    is_removed.resize(meshes(), 0);
    ++layout;
}

void MovingScene::remove(std::uint32_t mesh) {
    const auto erase = [](auto& array, std::size_t from, std::size_t to) {
        array.erase(array.begin() + static_cast<std::ptrdiff_t>(from),
                    array.begin() + static_cast<std::ptrdiff_t>(to));
    };
    const std::size_t first = first_triangle[mesh];
    const std::size_t last = first_triangle[mesh + 1];
    erase(triangles, first, last);
    erase(mesh_of_triangle, first, last);
    const VertexId first_own = first_vertex[mesh];
    const VertexId own = first_vertex[mesh + 1] - first_own;
    erase(begin, first_own, first_own + own);
    erase(end, first_own, first_own + own);
    erase(deviation, first_own, first_own + own);
    // The vertices and triangles of later meshes move up.
    for (std::size_t i = first; i < triangles.size(); ++i) {
        for (VertexId& vertex : triangles[i]) {
            vertex -= own;
        }
    }
    for (std::size_t i = mesh + 1; i < first_vertex.size(); ++i) {
        first_vertex[i] -= own;
        first_triangle[i] -= last - first;
    }
    meshes_on_screws -= screws[mesh] ? 1 : 0;
    screws[mesh].reset();
    is_removed[mesh] = 1;
    ++layout;
}

bool MovingScene::set_begin(std::uint32_t mesh, std::span<const Vec3> positions) {
    EARSHOT_ASSERT(mesh < meshes() && is_removed[mesh] == 0);
    EARSHOT_ASSERT(first_vertex[mesh] + positions.size() == first_vertex[mesh + 1]);
    require_finite(mesh, positions);
    const VertexId first = first_vertex[mesh];
    const bool begins_elsewhere =
        assign(positions, std::span(begin).subspan(first, positions.size()));
    if (screws[mesh]) {
        screws[mesh].reset();
        --meshes_on_screws;
        std::fill_n(deviation.begin() + static_cast<std::ptrdiff_t>(first), positions.size(), 0.0);
        ++revisions[mesh];
    }
    return begins_elsewhere;
}

bool MovingScene::move(std::uint32_t mesh, std::span<const Vec3> from, std::span<const Vec3> to) {
    EARSHOT_ASSERT(from.size() == to.size());
    require_finite(mesh, to);
    const bool begins_elsewhere = set_begin(mesh, from);
    const bool ends_elsewhere = assign(to, std::span(end).subspan(first_vertex[mesh], to.size()));
    revisions[mesh] += begins_elsewhere || ends_elsewhere ? 1 : 0;
    return begins_elsewhere;
}

bool MovingScene::move(std::uint32_t mesh, std::span<const Vec3> from, const Screw& screw) {
    const bool begins_elsewhere = set_begin(mesh, from);
    screws[mesh] = screw;
    ++meshes_on_screws;
    ++revisions[mesh];
    const VertexId first = first_vertex[mesh];
    const VertexId last = first_vertex[mesh + 1];
    for (VertexId vertex = first; vertex < last; ++vertex) {
        end[vertex] = screw.apply(begin[vertex], 1.0);
        deviation[vertex] = screw.chord_deviation(begin[vertex]);
    }
    require_finite(mesh, std::span(end).subspan(first, last - first));
    return begins_elsewhere;
}

std::span<const Triangle> MovingScene::triangles_of(std::uint32_t mesh) const noexcept {
    return std::span(triangles).subspan(first_triangle[mesh],
                                        first_triangle[mesh + 1] - first_triangle[mesh]);
}

IndexRange MovingScene::vertex_range(std::uint32_t mesh) const noexcept {
    return {first_vertex[mesh], first_vertex[mesh + 1]};
}

IndexRange MovingScene::triangle_range(std::uint32_t mesh) const noexcept {
    return {static_cast<std::uint32_t>(first_triangle[mesh]),
            static_cast<std::uint32_t>(first_triangle[mesh + 1])};
}

MovingCorners MovingScene::corners_of(const Triangle& t) const noexcept {
    return {geometry::corners(begin, t), geometry::corners(end, t)};
}

MovingPoints MovingScene::points_of(const std::array<VertexId, 4>& vertices) const noexcept {
    const auto [a, b, c, d] = vertices;
    return {{begin[a], begin[b], begin[c], begin[d]}, {end[a], end[b], end[c], end[d]}};
}

void MovingScene::rest_if_on_screw(std::uint32_t mesh, MovingPoints& points) const noexcept {
    if (screws[mesh]) {
        points.end = points.begin;
    }
}

double MovingScene::deviation_of(const Triangle& t) const noexcept {
    return meshes_on_screws == 0 ? 0.0
                                 : std::max({deviation[t[0]], deviation[t[1]], deviation[t[2]]});
}

bool MovingScene::on_screws(std::uint32_t mesh_a, std::uint32_t mesh_b) const noexcept {
    return screws[mesh_a] != screws[mesh_b];
}

ScrewPoints MovingScene::screw_points_of(const std::array<VertexId, 4>& vertices,
                                         std::uint32_t mesh_a,
                                         std::uint32_t mesh_b) const noexcept {
    ScrewPoints points{.first = screw_of(mesh_a), .second = screw_of(mesh_b)};
    for (std::size_t i = 0; i < 4; ++i) {
        points.begin[i] = begin[vertices[i]];
        points.end[i] = end[vertices[i]];
    }
    return points;
}

Element MovingScene::element(std::uint32_t mesh, std::span<const VertexId> vertices) const {
    Element element{.mesh = mesh, .size = static_cast<std::uint32_t>(vertices.size())};
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        element.vertices[i] = vertices[i] - first_vertex[mesh];
    }
    std::sort(element.vertices.begin(),
              element.vertices.begin() + static_cast<std::ptrdiff_t>(vertices.size()));
    return element;
}

void MovingScene::set_point_and_normal(const std::array<VertexId, 4>& vertices,
                                       Contact& contact) const {
    const ScrewPoints points = screw_points_of(vertices, contact.a.mesh, contact.b.mesh);
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = points.at(i, contact.a.size, contact.toi);
    }
    Vec3 from_b;  // to a, at the beginning
    if (contact.kind == ContactKind::vertex_face) {
        contact.point = x[0];
        contact.normal = geometry::normalized_or_zero(glm::cross(x[2] - x[1], x[3] - x[1]));
        from_b = begin[vertices[0]] - begin[vertices[1]];
    } else {
        const Vec3 along = x[1] - x[0];
        const Vec3 normal = glm::cross(along, x[3] - x[2]);
        contact.normal = geometry::normalized_or_zero(normal);
        // a + u (b - a) on the plane of the other edge and the normal.
        const double area = glm::dot(normal, normal);
        const double parameter =
            area > 0.0 ? glm::dot(glm::cross(x[2] - x[0], x[3] - x[2]), normal) / area : 0.5;
        contact.point = x[0] + std::clamp(parameter, 0.0, 1.0) * along;
        from_b = begin[vertices[0]] - begin[vertices[2]];
    }
    if (glm::dot(contact.normal, from_b) < 0.0) {
        contact.normal = -contact.normal;
    }
}

}  // namespace earshot::collision
