// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"
#include "earshot/collision/world.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

namespace earshot::collision {

// Meshes that move during a step, and their contacts found without any hierarchy.

struct MovingMesh {
    std::vector<geometry::Triangle> triangles;
    std::vector<geometry::Vec3> begin, end;
};

using Found = std::tuple<ContactKind, Element, Element, double>;

inline Found found(const Contact& contact) {
    return {contact.kind, contact.a, contact.b, contact.toi};
}

inline Element element(std::uint32_t mesh, std::vector<geometry::VertexId> vertices) {
    std::sort(vertices.begin(), vertices.end());
    Element element{.mesh = mesh, .size = static_cast<std::uint32_t>(vertices.size())};
    std::copy(vertices.begin(), vertices.end(), element.vertices.begin());
    return element;
}

/// Every vertex against every face and every edge against every edge, but for those of one mesh
/// that share a vertex.
inline std::set<Found> brute_force(const std::vector<MovingMesh>& meshes,
                                   bool between,
                                   bool within) {
    std::set<Element> vertices, edges, faces;
    for (std::uint32_t m = 0; m < meshes.size(); ++m) {
        for (const geometry::Triangle& t : meshes[m].triangles) {
            faces.insert(element(m, {t[0], t[1], t[2]}));
            for (std::size_t k = 0; k < 3; ++k) {
                vertices.insert(element(m, {t[k]}));
                edges.insert(element(m, {t[k], t[(k + 1) % 3]}));
            }
        }
    }
    const auto test = [&](const Element& a, const Element& b) -> std::optional<double> {
        if (a.mesh == b.mesh ? !within : !between) {
            return std::nullopt;
        }
        MovingPoints points;
        std::size_t n = 0;
        for (const Element* x : {&a, &b}) {
            for (std::size_t i = 0; i < x->size; ++i) {
                if (a.mesh == b.mesh && x == &b &&
                    std::count(a.vertices.begin(), a.vertices.begin() + a.size, b.vertices[i]) >
                        0) {
                    return std::nullopt;
                }
                points.begin[n] = meshes[x->mesh].begin[x->vertices[i]];
                points.end[n++] = meshes[x->mesh].end[x->vertices[i]];
            }
        }
        return a.size == 1 ? vertex_face_ccd(points) : edge_edge_ccd(points);
    };
    std::set<Found> result;
    for (const Element& vertex : vertices) {
        for (const Element& face : faces) {
            if (const auto time = test(vertex, face)) {
                result.insert({ContactKind::vertex_face, vertex, face, *time});
            }
        }
    }
    for (const Element& a : edges) {
        for (const Element& b : edges) {
            if (a < b) {
                if (const auto time = test(a, b)) {
                    result.insert({ContactKind::edge_edge, a, b, *time});
                }
            }
        }
    }
    return result;
}

inline World world_of(const std::vector<MovingMesh>& meshes) {
    World world;
    for (const MovingMesh& mesh : meshes) {
        world.update(world.add_mesh(mesh.triangles, mesh.begin.size()), mesh.begin, mesh.end);
    }
    return world;
}

}  // namespace earshot::collision
