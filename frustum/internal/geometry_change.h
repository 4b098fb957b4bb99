// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/types.h"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::frustum {

/// A copy of what searches read of a scene at one instant, to tell at the next what has changed.
class GeometrySnapshot {
public:
    GeometrySnapshot(const SceneView& scene, const FacetIndex& index);

private:
    friend class GeometryChange;

    struct Record {
        geometry::Plane plane;
        double deviation = 0.0;
        double max_pressure_factor = 1.0;
        std::uint32_t triangle_count = 0;
        std::uint32_t first_vertex = 0, vertex_count = 0;  // of the outline
        bool is_one_sided = false;
        bool is_transmissive = false;
        bool is_opaque = true;
    };

    Record record_of(const SceneView& scene, const FacetIndex& index, geometry::FacetId id);

    std::vector<geometry::Triangle> triangles_;
    std::vector<geometry::Vec3> positions_;
    std::vector<geometry::FacetId> of_triangle_;
    std::vector<Record> records_;            // per facet
    std::vector<geometry::Aabb> boxes_;      // likewise, of all that belongs to it
    std::vector<geometry::Vec3> outlines_;   // of all facets
    std::vector<std::uint32_t> loop_ends_;   // likewise, into outlines_
    std::vector<std::uint32_t> first_loop_;  // per facet, and one past the last
    double tolerance_ = 0.0;
    double extent_ = 0.0;
    double bvh_extent_ = 0.0;
};

/// What has changed between two instants of a scene. A facet is unchanged if it is made of the same
/// triangles in the same places and whatever a search reads of it is the same, to the last bit;
/// only its number may be another. All others are changed facets, which were where their boxes at
/// the instant before are and are where their boxes at the instant after are: the swept boxes
/// (Bittner et al. 2011, section 4.4, of moving shadow casters). What no swept box meets is as it
/// was.
class GeometryChange {
public:
    static constexpr geometry::FacetId kChanged = std::numeric_limits<geometry::FacetId>::max();

    GeometryChange(const GeometrySnapshot& before,
                   const GeometrySnapshot& after,
                   Executor& executor);

    /// Whether nothing is known to be as it was: the triangles are others, the tolerances that
    /// every decision shares are others, or every facet has changed.
    bool is_total() const noexcept { return is_total_; }

    /// The numbers of an unchanged facet at the other instant; kChanged of a changed one.
    geometry::FacetId after(geometry::FacetId before) const noexcept { return after_[before]; }
    geometry::FacetId before(geometry::FacetId after) const noexcept { return before_[after]; }

    /// Whether a triangle belonged to a facet that is unchanged.
    bool is_unchanged(geometry::TriangleId triangle) const noexcept {
        return after_[of_triangle_before_[triangle]] != kChanged;
    }

    /// Whether a changed facet may have touched or may touch the segment.
    bool may_touch(const geometry::Segment& segment) const;

    /// Whether some swept box passes the test. `overlaps` may not fail for a box around one that it
    /// passes.
    template <std::predicate<const geometry::Aabb&> Overlaps,
              std::predicate<const geometry::Aabb&> Test>
    bool any_swept_box(Overlaps&& overlaps, Test&& test) const;

private:
    bool is_same_facet(const GeometrySnapshot& before,
                       geometry::FacetId old,
                       const GeometrySnapshot& after,
                       geometry::FacetId now) const;

    bool is_total_ = true;
    std::vector<geometry::FacetId> after_, before_;
    std::vector<geometry::FacetId> of_triangle_before_;
    std::vector<geometry::Aabb> swept_boxes_;
    bvh::DeformableBvh bvh_;  // over them
    double max_abs_coordinate_ = 0.0;
};

template <std::predicate<const geometry::Aabb&> Overlaps,
          std::predicate<const geometry::Aabb&> Test>
bool GeometryChange::any_swept_box(Overlaps&& overlaps, Test&& test) const {
    const bvh::Tree& tree = bvh_.binary_tree();
    const auto nodes = tree.nodes();
    std::vector<std::uint32_t> stack;
    if (!nodes.empty() && overlaps(nodes.front().box)) {
        stack.push_back(0);
    }
    while (!stack.empty()) {
        const bvh::Node& node = nodes[stack.back()];
        stack.pop_back();
        for (std::uint32_t i = 0; i < node.count; ++i) {
            const geometry::Aabb& box = swept_boxes_[tree.primitives()[node.first + i]];
            if (overlaps(box) && test(box)) {
                return true;
            }
        }
        for (std::uint32_t child = node.first; !node.is_leaf() && child < node.first + 2; ++child) {
            if (overlaps(nodes[child].box)) {
                stack.push_back(child);
            }
        }
    }
    return false;
}

}  // namespace earshot::frustum
