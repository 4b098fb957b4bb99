// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/exposed_layers.h"

#include "earshot/geometry/vector.h"

#include <numeric>

namespace earshot::propagation {

using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Rays start so many tolerances before both layers.
constexpr double kOffsetInTolerances = 8.0;

/// Whether sound is before a place: a ray that leaves it meets a side in the air.
bool faces_air(const CheckedMesh& mesh,
               const Vec3& point,
               const Vec3& normal,
               const std::function<bool(visibility::SideId)>& is_air) {
    const geometry::Ray ray{point + kOffsetInTolerances * mesh.tolerance() * normal, normal};
    const auto hit = mesh.bvh().closest_hit(ray);
    if (!hit) {
        return false;
    }
    const auto [a, b, c] = mesh.bvh().corners(hit->triangle);
    const bool hits_back = glm::dot(glm::cross(b - a, c - a), normal) > 0.0;
    return is_air(hits_back ? visibility::back_of(hit->triangle)
                            : visibility::front_of(hit->triangle));
}

}  // namespace

std::vector<frustum::LayerOverlap> find_exposed_layers(
    const CheckedMesh& mesh,
    const geometry::Facets& facets,
    const std::function<bool(visibility::SideId)>& is_air) {
    // With a label each, all pairs of triangles count.
    std::vector<std::uint32_t> labels(mesh.size());
    std::iota(labels.begin(), labels.end(), 0U);
    std::vector<frustum::LayerOverlap> exposed;
    for (const frustum::LayerOverlap& overlap :
         frustum::find_layer_overlaps({.bvh = mesh.bvh(), .facets = facets}, labels)) {
        const auto [a, b, c] = mesh.bvh().corners(overlap.first);
        const Vec3 normal = geometry::normalized_or_zero(glm::cross(b - a, c - a));
        if (faces_air(mesh, overlap.point, normal, is_air) ||
            faces_air(mesh, overlap.point, -normal, is_air)) {
            exposed.push_back(overlap);
        }
    }
    return exposed;
}

}  // namespace earshot::propagation
