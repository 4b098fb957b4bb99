// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/coincident_layers.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::frustum {

using geometry::Facet;
using geometry::FacetId;
using geometry::TriangleId;
using geometry::Vec3;

double max_layer_distance(const geometry::Facets& facets, const Facet& a, const Facet& b) noexcept {
    return a.deviation + b.deviation + facets.tolerance;
}

bool are_coincident_at(const geometry::Facets& facets,
                       const Facet& a,
                       const Vec3& on_a,
                       const Facet& b,
                       const Vec3& on_b) noexcept {
    const double max_distance = max_layer_distance(facets, a, b);
    return glm::length(glm::cross(a.plane.normal, b.plane.normal)) <= kMaxLayerTilt &&
           std::abs(a.plane.distance(on_b)) <= max_distance &&
           std::abs(b.plane.distance(on_a)) <= max_distance;
}

bool is_coincident_layer(const SceneView& scene,
                         const Facet& surface,
                         TriangleId triangle) noexcept {
    const geometry::Facets& facets = scene.facets;
    const double deviation =
        surface.deviation + facets.facets[facets.of_triangle[triangle]].deviation;
    const geometry::Triangle& corners = scene.mesh().triangles[triangle];
    return std::all_of(corners.begin(), corners.end(), [&](geometry::VertexId vertex) {
        return std::abs(surface.plane.distance(scene.mesh().positions[vertex])) <=
               deviation + facets.tolerance;
    });
}

// For every transmissive triangle the hierarchy gives the triangles whose boxes come close to its
// own. That their planes agree is left to the verification, which looks at a point.
std::vector<std::uint8_t> find_transmissive_layers(const SceneView& scene) {
    const auto& facets = scene.facets;
    if (std::none_of(scene.transmissive.begin(), scene.transmissive.end(), [](std::uint8_t is) {
            return is != 0;
        })) {
        return {};
    }
    std::vector<std::uint8_t> may_be_covered(facets.facets.size(), 0);
    for (std::size_t i = 0; i < scene.mesh().triangles.size(); ++i) {
        const auto id = static_cast<TriangleId>(i);
        const FacetId facet = facets.of_triangle[id];
        if (scene.transmissive[facet] == 0) {
            continue;
        }
        const double margin = facets.facets[facet].deviation + 2.0 * facets.tolerance;
        geometry::Aabb box;
        for (const geometry::VertexId vertex : scene.mesh().triangles[id]) {
            box.include(scene.mesh().positions[vertex] - margin);
            box.include(scene.mesh().positions[vertex] + margin);
        }
        const auto overlaps = [&](const geometry::Aabb& other) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (other.lower[k] > box.upper[k] || other.upper[k] < box.lower[k]) {
                    return false;
                }
            }
            return true;
        };
        scene.bvh.traverse(overlaps, [&](TriangleId other) {
            const FacetId covered = facets.of_triangle[other];
            if (other > id && scene.transmissive[covered] == 0 &&
                glm::length(glm::cross(facets.facets[facet].plane.normal,
                                       facets.facets[covered].plane.normal)) <= kMaxLayerTilt) {
                may_be_covered[covered] = 1;
            }
            return true;
        });
    }
    return may_be_covered;
}

}  // namespace earshot::frustum
