// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/internal/facet_tree.h"
#include "earshot/frustum/scene_view.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Facets prepared for frusta: outlines that lie exactly in the facet's plane (up to rounding), a
/// hierarchy over their boxes, and the tolerances that the search and the verification share.
class FacetIndex {
public:
    explicit FacetIndex(const SceneView& scene, Executor& executor = Executor::serial());

    /// Of the scene at another instant: the hierarchy of `before` follows the facets if they are
    /// made of the same triangles, for about `queries` frusta.
    FacetIndex(const SceneView& scene, FacetIndex&& before, double queries, Executor& executor);

    struct LoopRange {
        std::uint32_t begin = 0, end = 0;  ///< into vertices()
    };

    std::size_t size() const noexcept { return facets_->size(); }
    const geometry::Plane& plane(geometry::FacetId facet) const noexcept {
        return (*facets_)[facet].plane;
    }
    bool is_one_sided(geometry::FacetId facet) const noexcept {
        return !one_sided_.empty() && one_sided_[facet] != 0;
    }
    bool is_transmissive(geometry::FacetId facet) const noexcept {
        return !transmissive_.empty() && transmissive_[facet] != 0;
    }
    /// Whether no sound passes it: neither it nor a layer that counts in its place is transmissive.
    bool is_opaque(geometry::FacetId facet) const noexcept {
        return !is_transmissive(facet) && (may_be_covered_.empty() || may_be_covered_[facet] == 0);
    }
    /// The largest factor by which meeting the facet multiplies the pressure of a path.
    double max_pressure_factor(geometry::FacetId facet) const noexcept {
        return max_pressure_factor_.empty() ? 1.0 : max_pressure_factor_[facet];
    }
    /// Metres: how far the facet's triangles may lie from its plane.
    double deviation(geometry::FacetId facet) const noexcept { return (*facets_)[facet].deviation; }
    /// Metres: how far points of the facet's triangles may lie from its outline, in all.
    double flatness(geometry::FacetId facet) const noexcept {
        return (*facets_)[facet].deviation + tolerance_;
    }

    /// Border loops of a facet: ranges of vertices().
    std::span<const LoopRange> loops(geometry::FacetId facet) const noexcept;
    /// Border vertices moved into the facet's plane along the plane's dominant axis, the direction
    /// in which the verification projects (path_verifier.cpp), so that search and verification mean
    /// the same polygon.
    std::span<const geometry::Vec3> vertices() const noexcept { return vertices_; }
    const FacetTree& tree() const noexcept { return tree_; }
    /// How many hierarchies there have been, and how they followed the facets.
    std::uint64_t hierarchies_built() const noexcept { return hierarchies_built_; }
    const bvh::UpdateStatistics& updates() const noexcept { return updates_; }
    /// The outward-rounded box of a facet.
    const geometry::Aabb& box(geometry::FacetId facet) const noexcept { return boxes_[facet]; }

    /// Largest absolute coordinate of the scene, metres.
    double extent() const noexcept { return extent_; }

private:
    void describe_facets(const SceneView& scene, Executor& executor);
    void describe_outline(geometry::FacetId facet);

    const std::vector<geometry::Facet>* facets_;
    std::span<const std::uint8_t> one_sided_, transmissive_;
    std::span<const double> max_pressure_factor_;
    std::vector<std::uint8_t> may_be_covered_;  // by a transmissive layer
    std::vector<std::uint32_t> first_loop_;     // per facet, and one past the last
    std::vector<LoopRange> loops_;
    std::vector<geometry::Vec3> vertices_;
    std::vector<geometry::Aabb> boxes_;
    std::vector<geometry::FacetId> of_triangle_;  // what the facets are made of
    bvh::DeformableBvh bvh_;                      // over the boxes
    FacetTree tree_;                              // its levels joined
    std::uint64_t hierarchies_built_ = 0;
    bvh::UpdateStatistics updates_;
    double extent_ = 0.0;
    double tolerance_ = 0.0;
};

/// Rounding slack of constructed points, metres: mirrored points and intersections are off by a few
/// units in the last place (2^-53) of the distances involved for each of up to ~16 reflections;
/// 2^-42 leaves a factor of about a hundred.
inline constexpr double kRounding = 0x1p-42;

/// The axis of the largest component of a normal; lowest of equals.
int dominant_axis(const geometry::Vec3& normal) noexcept;

/// Moves a point into a plane along the given axis.
geometry::Vec3 snap_to_plane(const geometry::Plane& plane,
                             const geometry::Vec3& point,
                             int axis) noexcept;

}  // namespace earshot::frustum
