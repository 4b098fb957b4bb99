// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/geometry_change.h"

#include "earshot/geometry/intersect.h"

#include <algorithm>
#include <cstring>

namespace earshot::frustum {

using geometry::Aabb;
using geometry::FacetId;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Zeros of different signs differ.
template <typename Value>
bool same_bits(std::span<const Value> a, std::span<const Value> b) noexcept {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

bool same_bits(const Vec3& a, const Vec3& b) noexcept {
    return std::memcmp(&a, &b, sizeof(Vec3)) == 0;
}

bool same_bits(double a, double b) noexcept {
    return std::memcmp(&a, &b, sizeof(double)) == 0;
}

}  // namespace

GeometrySnapshot::GeometrySnapshot(const SceneView& scene, const FacetIndex& index)
    : triangles_(scene.mesh().triangles.begin(), scene.mesh().triangles.end()),
      positions_(scene.mesh().positions.begin(), scene.mesh().positions.end()),
      of_triangle_(scene.facets.of_triangle),
      tolerance_(scene.facets.tolerance),
      extent_(index.extent()),
      bvh_extent_(scene.bvh.max_abs_coordinate()) {
    for (std::size_t i = 0; i < index.size(); ++i) {
        const auto facet = static_cast<FacetId>(i);
        records_.push_back(record_of(scene, index, facet));
        // Legs meet the triangles themselves, frusta the outline in the facet's plane.
        Aabb box = index.box(facet);
        for (const TriangleId triangle : scene.facets.facets[facet].triangles) {
            for (const geometry::VertexId vertex : triangles_[triangle]) {
                box.include(positions_[vertex]);
            }
        }
        boxes_.push_back(box);
    }
    first_loop_.push_back(static_cast<std::uint32_t>(loop_ends_.size()));
}

GeometrySnapshot::Record GeometrySnapshot::record_of(const SceneView& scene,
                                                     const FacetIndex& index,
                                                     FacetId id) {
    const geometry::Facet& facet = scene.facets.facets[id];
    Record record{.plane = facet.plane,
                  .deviation = facet.deviation,
                  .max_pressure_factor = index.max_pressure_factor(id),
                  .triangle_count = static_cast<std::uint32_t>(facet.triangles.size()),
                  .first_vertex = static_cast<std::uint32_t>(outlines_.size()),
                  .is_one_sided = index.is_one_sided(id),
                  .is_transmissive = index.is_transmissive(id),
                  .is_opaque = index.is_opaque(id)};
    first_loop_.push_back(static_cast<std::uint32_t>(loop_ends_.size()));
    for (const FacetIndex::LoopRange& loop : index.loops(id)) {
        const auto vertices = index.vertices().subspan(loop.begin, loop.end - loop.begin);
        outlines_.insert(outlines_.end(), vertices.begin(), vertices.end());
        loop_ends_.push_back(static_cast<std::uint32_t>(outlines_.size()) - record.first_vertex);
    }
    record.vertex_count = static_cast<std::uint32_t>(outlines_.size()) - record.first_vertex;
    return record;
}

GeometryChange::GeometryChange(const GeometrySnapshot& before,
                               const GeometrySnapshot& after,
                               Executor& executor) {
    if (before.triangles_ != after.triangles_ ||
        before.positions_.size() != after.positions_.size() ||
        !same_bits(before.tolerance_, after.tolerance_) ||
        !same_bits(before.extent_, after.extent_) ||
        !same_bits(before.bvh_extent_, after.bvh_extent_)) {
        return;
    }
    after_.assign(before.records_.size(), kChanged);
    before_.assign(after.records_.size(), kChanged);
    of_triangle_before_ = before.of_triangle_;
    // A facet is where one of its triangles was. That all of them were there shows as follows: a
    // facet of as many triangles as before, all of them of the one facet before.
    std::vector<std::uint8_t> differs(after.records_.size(), 0);
    std::vector<FacetId> candidate(after.records_.size(), kChanged);
    for (std::size_t i = 0; i < after.of_triangle_.size(); ++i) {
        const FacetId now = after.of_triangle_[i];
        const FacetId old = before.of_triangle_[i];
        if (candidate[now] == kChanged) {
            candidate[now] = old;
        }
        bool is_same = candidate[now] == old;
        for (const geometry::VertexId vertex : after.triangles_[i]) {
            is_same = is_same && same_bits(before.positions_[vertex], after.positions_[vertex]);
        }
        differs[now] |= is_same ? 0 : 1;
    }
    for (std::size_t i = 0; i < after.records_.size(); ++i) {
        const auto now = static_cast<FacetId>(i);
        if (differs[i] == 0 && candidate[i] != kChanged &&
            is_same_facet(before, candidate[i], after, now)) {
            before_[now] = candidate[i];
            after_[candidate[i]] = now;
        }
    }
    // Where the changed ones were and are.
    max_abs_coordinate_ = after.bvh_extent_;
    const auto add_swept_boxes = [&](const std::vector<FacetId>& other,
                                     const std::vector<Aabb>& boxes) {
        for (std::size_t i = 0; i < other.size(); ++i) {
            if (other[i] == kChanged) {
                swept_boxes_.push_back(boxes[i]);
                max_abs_coordinate_ = std::max(max_abs_coordinate_, boxes[i].max_abs_coordinate());
            }
        }
    };
    add_swept_boxes(before_, after.boxes_);
    is_total_ = swept_boxes_.size() == after.records_.size();
    add_swept_boxes(after_, before.boxes_);
    if (!is_total_) {
        bvh_ = bvh::DeformableBvh(swept_boxes_, {}, executor);
    }
}

bool GeometryChange::is_same_facet(const GeometrySnapshot& before,
                                   FacetId old,
                                   const GeometrySnapshot& after,
                                   FacetId now) const {
    const GeometrySnapshot::Record& a = before.records_[old];
    const GeometrySnapshot::Record& b = after.records_[now];
    const auto outline = [](const GeometrySnapshot& snapshot, const auto& record) {
        return std::span(snapshot.outlines_).subspan(record.first_vertex, record.vertex_count);
    };
    const auto loop_ends = [](const GeometrySnapshot& snapshot, FacetId facet) {
        const std::uint32_t first = snapshot.first_loop_[facet];
        return std::span(snapshot.loop_ends_)
            .subspan(first, snapshot.first_loop_[facet + 1] - first);
    };
    return a.triangle_count == b.triangle_count && a.is_one_sided == b.is_one_sided &&
           a.is_transmissive == b.is_transmissive && a.is_opaque == b.is_opaque &&
           same_bits(a.deviation, b.deviation) && same_bits(a.plane.normal, b.plane.normal) &&
           same_bits(a.plane.offset, b.plane.offset) &&
           same_bits(a.max_pressure_factor, b.max_pressure_factor) &&
           before.boxes_[old] == after.boxes_[now] &&
           same_bits(loop_ends(before, old), loop_ends(after, now)) &&
           same_bits(outline(before, a), outline(after, b));
}

// The test of boxes by which a leg that is verified finds its obstacles: what it misses, the leg
// does not touch.
bool GeometryChange::may_touch(const geometry::Segment& segment) const {
    const geometry::SlabTest slab_test(
        segment.from, segment.to - segment.from, max_abs_coordinate_);
    return any_swept_box([&](const Aabb& box) { return !slab_test.interval(box, 1.0).is_empty(); },
                         [](const Aabb&) { return true; });
}

}  // namespace earshot::frustum
