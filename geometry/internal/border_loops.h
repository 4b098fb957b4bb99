// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"
#include "earshot/geometry/topology.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// Walks along the borders of facets.
class BorderWalk {
public:
    /// `triangles` are welded, `twins` as twins_of() gives them; all three outlive the walk.
    BorderWalk(std::span<const Triangle> triangles,
               std::span<const HalfEdgeId> twins,
               std::span<const FacetId> of_triangle,
               std::size_t vertex_count);

    /// The borders of the facet made of `members`, as vertex loops that visit no vertex twice.
    /// Slits (there and back along the same edges) are left out.
    std::vector<std::vector<VertexId>> loops(std::span<const TriangleId> members);

private:
    bool is_border(HalfEdgeId h) const noexcept;
    void trace(HalfEdgeId first, std::vector<std::vector<VertexId>>& loops);

    std::span<const Triangle> triangles_;
    std::span<const HalfEdgeId> twins_;
    std::span<const FacetId> of_triangle_;
    std::vector<bool> walked_;          // per half-edge
    std::vector<std::uint32_t> place_;  // per vertex: where it stands in path_
    std::vector<VertexId> path_;
};

/// The corners of a closed polygon: vertices within `tolerance` of the straight line between the
/// corners next to them are left out (Douglas and Peucker 1973, started at two extreme vertices),
/// so that the result does not depend on where the loop began. At least three remain.
Loop corners_of(const std::vector<Vec3>& polygon, double tolerance);

}  // namespace earshot::geometry
