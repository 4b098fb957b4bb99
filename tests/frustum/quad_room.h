// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/scene_view.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace earshot::frustum {

/// A room of flat quadrilaterals, each a facet of two triangles, whose facets are known without
/// find_facets.
class QuadRoom {
public:
    using Vec3 = geometry::Vec3;

    /// Corners counter-clockwise seen from the front.
    void add_quad(
        const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, bool one_sided = false) {
        const auto vertex = static_cast<geometry::VertexId>(mesh_.positions.size());
        const auto triangle = static_cast<geometry::TriangleId>(mesh_.triangles.size());
        mesh_.positions.insert(mesh_.positions.end(), {a, b, c, d});
        mesh_.triangles.push_back({vertex, vertex + 1, vertex + 2});
        mesh_.triangles.push_back({vertex, vertex + 2, vertex + 3});
        geometry::Facet facet;
        facet.plane.normal = glm::normalize(glm::cross(b - a, c - a));
        facet.plane.offset = glm::dot(facet.plane.normal, a);
        for (const Vec3& corner : {a, b, c, d}) {
            facet.deviation = std::max(facet.deviation, std::abs(facet.plane.distance(corner)));
        }
        facet.triangles = {triangle, triangle + 1};
        facet.loops = {{a, b, c, d}};
        const auto id = static_cast<geometry::FacetId>(facets_.facets.size());
        facets_.of_triangle.insert(facets_.of_triangle.end(), {id, id});
        facets_.facets.push_back(facet);
        one_sided_.push_back(one_sided ? 1 : 0);
    }

    /// A parallelepiped with its fronts outside, or inside for a room.
    void add_box(
        const Vec3& origin, const Vec3& x, const Vec3& y, const Vec3& z, bool inside = false) {
        const auto at = [&](double i, double j, double k) {
            return origin + i * x + j * y + k * z;
        };
        const auto face = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
            inside ? add_quad(a, b, c, d) : add_quad(d, c, b, a);
        };
        face(at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0));
        face(at(0, 0, 1), at(0, 1, 1), at(1, 1, 1), at(1, 0, 1));
        face(at(0, 0, 0), at(0, 0, 1), at(1, 0, 1), at(1, 0, 0));
        face(at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1));
        face(at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1));
        face(at(1, 0, 0), at(1, 0, 1), at(1, 1, 1), at(1, 1, 0));
    }

    /// To be called after the last quad.
    void finish() {
        double scale = 0.0;
        for (const Vec3& p : mesh_.positions) {
            scale = std::max({scale, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        }
        facets_.tolerance = 4.0 * 0x1p-23 * scale;
        bvh_ = bvh::DeformableBvh(mesh_.view());
    }

    SceneView scene_view() const {
        return {.bvh = {bvh_.tree(), mesh_.view()}, .facets = facets_, .one_sided = one_sided_};
    }

private:
    geometry::Mesh mesh_;
    geometry::Facets facets_;
    std::vector<std::uint8_t> one_sided_;
    bvh::DeformableBvh bvh_;
};

/// A room with boxes in it, some turned against the walls, and points in the air (a point inside a
/// box has no path, which is an answer too).
struct RandomRoom {
    QuadRoom room;
    geometry::Vec3 source{0.0};
    std::vector<geometry::Vec3> listeners;

    RandomRoom(std::uint64_t seed, int boxes) {
        using geometry::Vec3;
        const auto uniform = [&](std::uint64_t stream, std::uint64_t i, double low, double high) {
            return random_between(seed, stream, i, low, high);
        };
        const auto turned = [](double angle) {
            return std::pair(Vec3(std::cos(angle), 0.0, std::sin(angle)),
                             Vec3(-std::sin(angle), 0.0, std::cos(angle)));
        };
        const Vec3 size = {uniform(0, 0, 4, 12), uniform(0, 1, 2.5, 5), uniform(0, 2, 4, 12)};
        const double angle = seed % 2 == 0 ? uniform(0, 3, 0.0, 6.0) : 0.0;
        const auto [right, back] = turned(angle);
        const Vec3 up = {0.0, 1.0, 0.0};
        room.add_box(Vec3(0.0), size.x * right, size.y * up, size.z * back, true);
        const auto point = [&, r = right, b = back](std::uint64_t stream) {
            return uniform(stream, 0, 0.05, 0.95) * size.x * r +
                   uniform(stream, 1, 0.05, 0.95) * size.y * up +
                   uniform(stream, 2, 0.05, 0.95) * size.z * b;
        };
        for (int box = 0; box < boxes; ++box) {
            const auto stream = static_cast<std::uint64_t>(100 + box);
            const auto [x, z] = turned(seed % 3 == 0 ? angle : uniform(stream, 3, 0.0, 6.0));
            room.add_box(point(stream),
                         uniform(stream, 4, 0.01, 2.0) * x,
                         uniform(stream, 5, 0.01, 1.5) * up,
                         uniform(stream, 6, 0.01, 2.0) * z);
        }
        room.finish();
        source = point(5);
        listeners = {point(6), point(7), point(8)};
    }
};

}  // namespace earshot::frustum
