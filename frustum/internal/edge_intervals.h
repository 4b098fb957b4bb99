// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/path_verifier.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <array>
#include <span>
#include <vector>

namespace earshot::frustum {

/// The parts of edges that sound reaches over given sequences of facets. Every such part comes into
/// being here, as every path does in PathVerifier.
///
/// The ways from an image source over all points of an edge form a triangle, unfolded; folded back,
/// each leg has a triangle of its own, the *fan*, between an image of the source and one of the
/// edge. What is reached can change only where a way passes the outline of a facet that reflects,
/// an edge of a triangle that crosses the fan, or a place where planes of facets and the fan meet.
/// These places are found first, with some too many; between two of them one point tells for all.
/// PathVerifier decides on it, unless a triangle is certain to be in the way.
class EdgeIntervals {
public:
    EdgeIntervals(const SceneView& scene, const PathVerifier& verifier)
        : scene_(scene), verifier_(verifier) {}

    /// Whether an image is seen from the air of the wedge: not if it lies on the edge's line,
    /// outside of the wedge's sector or in the plane of a face on the face's side, where sound
    /// would graze it, and not if the edge lies in the plane of the last mirror, which is null for
    /// the point itself. `point`: the image about the wedge.
    bool may_reach(const geometry::FacetId* mirror,
                   const geometry::Vec3& image,
                   const geometry::WedgePoint& point,
                   const geometry::Wedge& wedge) const;

    /// Bounds of the places to which the facets reflect, without regard to what lies between; may
    /// be empty. Preconditions as for find().
    geometry::Interval window(std::span<const geometry::FacetId> sequence,
                              std::span<const geometry::Vec3> images,
                              const geometry::Wedge& wedge) const;

    /// The parts within a window, which is the window() or a part of it. Disjoint, ascending, in
    /// metres along the edge, each longer than the rounding of places, by which they may leave the
    /// window. The preconditions of `sequence` and `images` are those of PathVerifier::verify();
    /// the last image may_reach() the wedge.
    std::vector<geometry::Interval> find(std::span<const geometry::FacetId> sequence,
                                         std::span<const geometry::Vec3> images,
                                         const geometry::Wedge& wedge,
                                         const geometry::Interval& window) const;

    /// The same of an image that may not reach the wedge: then nothing.
    std::vector<geometry::Interval> find(std::span<const geometry::FacetId> sequence,
                                         std::span<const geometry::Vec3> images,
                                         const geometry::Wedge& wedge) const;

private:
    struct Fan;
    struct PlaneOverFan;
    struct Places;
    /// In the plane of a fan: metres from the edge's line towards the source, and along the edge.
    struct FanPoint {
        double r = 0.0;
        double z = 0.0;
    };

    std::vector<Fan> fans(std::span<const geometry::FacetId> sequence,
                          std::span<const geometry::Vec3> images,
                          const geometry::Wedge& wedge) const;
    void add_outline(const Fan& fan, geometry::FacetId facet, std::vector<double>& places) const;
    void add_plane(const Fan& fan, geometry::FacetId facet, std::vector<double>& places) const;
    void add_obstacles(const Fan& fan,
                       const geometry::Wedge& wedge,
                       const geometry::Interval& within,
                       Places& places) const;
    void add_obstacle(const Fan& fan, geometry::TriangleId triangle, Places& places) const;
    void add_shadow(const Fan& fan, const std::array<FanPoint, 2>& segment, Places& places) const;
    std::vector<double> mirror_places(std::span<const Fan> legs,
                                      const geometry::Wedge& wedge) const;
    double min_part(std::span<const geometry::Vec3> images, const geometry::Wedge& wedge) const;

    SceneView scene_;
    const PathVerifier& verifier_;
};

}  // namespace earshot::frustum
