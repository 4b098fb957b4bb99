// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/facet_index.h"

#include "earshot/frustum/internal/coincident_layers.h"

#include <algorithm>
#include <cmath>

namespace earshot::frustum {

using geometry::Vec3;

int dominant_axis(const Vec3& normal) noexcept {
    const Vec3 size = {std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    if (size.x >= size.y && size.x >= size.z) {
        return 0;
    }
    return size.y >= size.z ? 1 : 2;
}

Vec3 snap_to_plane(const geometry::Plane& plane, const Vec3& point, int axis) noexcept {
    Vec3 snapped = point;
    snapped[axis] -= plane.distance(point) / plane.normal[axis];
    return snapped;
}

FacetIndex::FacetIndex(const SceneView& scene)
    : facets_(&scene.facets.facets),
      one_sided_(scene.one_sided),
      transmissive_(scene.transmissive),
      max_pressure_factor_(scene.max_pressure_factor),
      may_be_covered_(find_transmissive_layers(scene)),
      tolerance_(scene.facets.tolerance) {
    for (const geometry::Triangle& triangle : scene.mesh().triangles) {
        for (const geometry::VertexId vertex : triangle) {
            const Vec3& p = scene.mesh().positions[vertex];
            extent_ = std::max({extent_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        }
    }
    boxes_.resize(facets_->size());
    first_loop_.reserve(facets_->size() + 1);
    for (std::size_t i = 0; i < facets_->size(); ++i) {
        const geometry::Facet& facet = (*facets_)[i];
        const int axis = dominant_axis(facet.plane.normal);
        const double margin = 2.0 * flatness(static_cast<geometry::FacetId>(i));
        first_loop_.push_back(static_cast<std::uint32_t>(loops_.size()));
        for (const geometry::Loop& loop : facet.loops) {
            const auto begin = static_cast<std::uint32_t>(vertices_.size());
            for (const Vec3& vertex : loop) {
                vertices_.push_back(snap_to_plane(facet.plane, vertex, axis));
                // Reflection points lie in the triangles moved into the plane along the
                // axis, at most sqrt(3) flatnesses from the outline.
                boxes_[i].include(vertices_.back() - margin);
                boxes_[i].include(vertices_.back() + margin);
            }
            loops_.push_back({begin, static_cast<std::uint32_t>(vertices_.size())});
        }
    }
    first_loop_.push_back(static_cast<std::uint32_t>(loops_.size()));
    tree_ = bvh::Tree::build(boxes_);
}

std::span<const FacetIndex::LoopRange> FacetIndex::loops(geometry::FacetId facet) const noexcept {
    return std::span(loops_).subspan(first_loop_[facet],
                                     first_loop_[facet + 1] - first_loop_[facet]);
}

}  // namespace earshot::frustum
