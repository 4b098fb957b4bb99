// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace earshot::frustum {

/// What a surface of a MovingRoom is made of; also the label of its triangles.
enum class Surface : std::uint32_t { plain, one_sided, transmissive, quiet };

/// A room with furniture and one part that moves: its triangles are always the same, the facets
/// that they make need not be. Made ready for the tracer anew at every instant, as a program does
/// that knows nothing of the instant before.
class MovingRoom {
public:
    using Vec3 = geometry::Vec3;

    void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Surface surface) {
        const auto first = static_cast<geometry::VertexId>(mesh_.positions.size());
        mesh_.positions.insert(mesh_.positions.end(), {a, b, c, d});
        mesh_.triangles.push_back({first, first + 1, first + 2});
        mesh_.triangles.push_back({first, first + 2, first + 3});
        labels_.insert(labels_.end(), 2, static_cast<std::uint32_t>(surface));
    }

    /// A parallelepiped with its fronts outside, or inside for a room.
    void add_box(const Vec3& origin,
                 const Vec3& x,
                 const Vec3& y,
                 const Vec3& z,
                 Surface surface,
                 bool inside = false) {
        const auto at = [&](int i, int j, int k) {
            return origin + double(i) * x + double(j) * y + double(k) * z;
        };
        const auto face = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
            inside ? add_quad(a, b, c, d, surface) : add_quad(d, c, b, a, surface);
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
        const geometry::CleanMesh clean = geometry::clean(mesh_.view());
        cleaned_.positions = mesh_.positions;
        std::vector<std::uint32_t> labels;
        for (const geometry::TriangleId triangle : clean.kept) {
            cleaned_.triangles.push_back(mesh_.triangles[triangle]);
            labels.push_back(labels_[triangle]);
        }
        facets_ = geometry::find_facets(cleaned_.view(), clean.weld, labels);
        bvh_ = bvh::DeformableBvh(cleaned_.view());
        for (const geometry::Facet& facet : facets_.facets) {
            const auto surface = static_cast<Surface>(labels[facet.triangles.front()]);
            one_sided_.push_back(surface == Surface::one_sided ? 1 : 0);
            transmissive_.push_back(surface == Surface::transmissive ? 1 : 0);
            max_pressure_factor_.push_back(surface == Surface::quiet ? 0.5 : 1.0);
        }
    }

    SceneView scene_view() const {
        return {.bvh = {bvh_.tree(), cleaned_.view()},
                .facets = facets_,
                .one_sided = one_sided_,
                .transmissive = transmissive_,
                .max_pressure_factor = max_pressure_factor_};
    }

private:
    geometry::Mesh mesh_, cleaned_;
    std::vector<std::uint32_t> labels_;
    geometry::Facets facets_;
    std::vector<std::uint8_t> one_sided_, transmissive_;
    std::vector<double> max_pressure_factor_;
    bvh::DeformableBvh bvh_;
};

}  // namespace earshot::frustum
