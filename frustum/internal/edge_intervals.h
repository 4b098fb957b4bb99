// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/path_verifier.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

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
/// These places are found first, with some too many; between two of them one point tells for all,
/// and PathVerifier decides on it.
class EdgeIntervals {
public:
    EdgeIntervals(const SceneView& scene, const PathVerifier& verifier)
        : scene_(scene), verifier_(verifier) {}

    /// Disjoint, ascending, in metres along the edge, each longer than the rounding of places. The
    /// preconditions of `sequence` and `images` are those of PathVerifier::verify(). Nothing if the
    /// last image lies on the edge's line, outside of the wedge's sector or in the plane of a face
    /// on the face's side, where sound would graze it.
    std::vector<geometry::Interval> find(std::span<const geometry::FacetId> sequence,
                                         std::span<const geometry::Vec3> images,
                                         const geometry::Wedge& wedge) const;

private:
    struct Fan;

    bool may_reach(std::span<const geometry::FacetId> sequence,
                   const geometry::Vec3& image,
                   const geometry::Wedge& wedge) const;
    std::vector<Fan> fans(std::span<const geometry::FacetId> sequence,
                          std::span<const geometry::Vec3> images,
                          const geometry::Wedge& wedge) const;
    void add_window(const Fan& fan, geometry::FacetId facet, std::vector<double>& places) const;
    void add_plane(const Fan& fan, geometry::FacetId facet, std::vector<double>& places) const;
    void add_obstacles(const Fan& fan,
                       const geometry::Wedge& wedge,
                       std::vector<double>& places) const;
    void add_obstacle(const Fan& fan,
                      geometry::TriangleId triangle,
                      std::vector<double>& places) const;

    SceneView scene_;
    const PathVerifier& verifier_;
};

}  // namespace earshot::frustum
