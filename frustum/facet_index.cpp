// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/facet_index.h"

#include "earshot/frustum/internal/coincident_layers.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

FacetIndex::FacetIndex(const SceneView& scene, Executor& executor) {
    describe_facets(scene, executor);
    bvh_ = bvh::DeformableBvh(boxes_, {}, executor);
    hierarchies_built_ = 1;
    tree_ = FacetTree(bvh_.binary_tree(), boxes_);
}

FacetIndex::FacetIndex(const SceneView& scene,
                       FacetIndex&& before,
                       double queries,
                       Executor& executor)
    : bvh_(std::move(before.bvh_)),
      hierarchies_built_(before.hierarchies_built_),
      updates_(before.updates_) {
    describe_facets(scene, executor);
    if (of_triangle_ == before.of_triangle_) {
        bvh_.expect_queries(queries);
        updates_.count(bvh_.update(boxes_, executor).action);
    } else {
        bvh_ = bvh::DeformableBvh(boxes_, {}, executor);
        ++hierarchies_built_;
    }
    tree_ = FacetTree(bvh_.binary_tree(), boxes_);
}

void FacetIndex::describe_facets(const SceneView& scene, Executor& executor) {
    facets_ = &scene.facets.facets;
    one_sided_ = scene.one_sided;
    transmissive_ = scene.transmissive;
    max_pressure_factor_ = scene.max_pressure_factor;
    may_be_covered_ = find_transmissive_layers(scene);
    tolerance_ = scene.facets.tolerance;
    of_triangle_ = scene.facets.of_triangle;
    for (const geometry::Triangle& triangle : scene.mesh().triangles) {
        for (const geometry::VertexId vertex : triangle) {
            extent_ = std::max(extent_, geometry::max_abs(scene.mesh().positions[vertex]));
        }
    }
    // Where the outlines go, then the outlines.
    first_loop_.reserve(facets_->size() + 1);
    std::uint32_t vertex_count = 0;
    for (const geometry::Facet& facet : *facets_) {
        first_loop_.push_back(static_cast<std::uint32_t>(loops_.size()));
        for (const geometry::Loop& loop : facet.loops) {
            const std::uint32_t end = vertex_count + static_cast<std::uint32_t>(loop.size());
            loops_.push_back({vertex_count, end});
            vertex_count = end;
        }
    }
    first_loop_.push_back(static_cast<std::uint32_t>(loops_.size()));
    vertices_.resize(vertex_count);
    boxes_.resize(facets_->size());
    constexpr std::size_t kGrain = 1024;
    executor.for_each(facets_->size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t facet = begin; facet < end; ++facet) {
            describe_outline(static_cast<geometry::FacetId>(facet));
        }
    });
}

void FacetIndex::describe_outline(geometry::FacetId id) {
    const geometry::Facet& facet = (*facets_)[id];
    const int axis = dominant_axis(facet.plane.normal);
    const double margin = 2.0 * flatness(id);
    Vec3 lower(std::numeric_limits<double>::infinity());
    Vec3 upper = -lower;
    for (std::size_t loop = 0; loop < facet.loops.size(); ++loop) {
        std::uint32_t next = loops_[first_loop_[id] + loop].begin;
        for (const Vec3& vertex : facet.loops[loop]) {
            const Vec3 snapped = snap_to_plane(facet.plane, vertex, axis);
            vertices_[next++] = snapped;
            lower = glm::min(lower, snapped);
            upper = glm::max(upper, snapped);
        }
    }
    if (!facet.loops.empty()) {
        // Reflection points lie in the triangles moved into the plane along the axis, at most
        // sqrt(3) flatnesses from the outline.
        boxes_[id].include(lower - margin);
        boxes_[id].include(upper + margin);
    }
}

std::span<const FacetIndex::LoopRange> FacetIndex::loops(geometry::FacetId facet) const noexcept {
    return std::span(loops_).subspan(first_loop_[facet],
                                     first_loop_[facet + 1] - first_loop_[facet]);
}

}  // namespace earshot::frustum
