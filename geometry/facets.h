// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/topology.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

using FacetId = std::uint32_t;

/// normal . x == offset. The normal has unit length but for rounding.
struct Plane {
    Vec3 normal{0.0, 1.0, 0.0};
    double offset = 0.0;

    /// Signed distance in metres, positive on the side the normal points to.
    double distance(const Vec3& point) const noexcept;
    /// The mirror image of a point; if the normal is a coordinate axis, rounded once.
    Vec3 mirror(const Vec3& point) const noexcept;
};

/// A closed polygon in space; the facet lies to its left seen against the normal, so outer borders
/// run counter-clockwise and holes clockwise. Vertices in the interior of a straight run are left
/// out. Starts at its smallest vertex (by x, then y, then z).
using Loop = std::vector<Vec3>;

/// Coplanar neighbouring triangles with one label: what sound reflects from.
struct Facet {
    Plane plane;             ///< of its largest triangle (lowest index of equals), its front side
    double deviation = 0.0;  ///< largest distance of a vertex from the plane, metres
    std::vector<TriangleId> triangles;  ///< ascending
    std::vector<Loop> loops;  ///< borders, outer ones and holes; none visits a vertex twice
};

struct Facets {
    std::vector<Facet> facets;         ///< ordered by their lowest triangle
    std::vector<FacetId> of_triangle;  ///< per triangle of the mesh
    double tolerance = 0.0;            ///< metres: coplanar_tolerance() of the mesh (tolerance.h)
};

/// Groups the triangles of a clean mesh (no degenerate or duplicate ones; see clean.h). Two
/// neighbours (sharing a welded edge that has just these two triangles, traversed in opposite
/// directions) are joined if their labels are equal, every vertex lies in the plane of the group's
/// largest triangle, and neither is folded back over the other. "In the plane" allows for
/// `tolerance`, and for the tilt that it gives the plane of a triangle only so wide: files store
/// floats, and the plane of a small triangle reaches far. Facet::deviation is what it came to; it
/// is 0 for a wall whose vertices share a coordinate. Loops leave out vertices within `tolerance`
/// of a straight run.
///
/// The result depends on the mesh alone; planes and loops of axis-aligned walls are the same bits
/// however the walls are cut into triangles. O(n log n). Precondition: weld.size() ==
/// positions.size(), labels.size() == triangles.size().
Facets find_facets(const MeshView& mesh,
                   std::span<const VertexId> weld,
                   std::span<const std::uint32_t> labels,
                   Executor& executor = Executor::serial());

/// find_facets() for a mesh that moves: what its vertices' positions do not change is found once.
class FacetFinder {
public:
    FacetFinder() = default;
    /// Preconditions as for find_facets().
    FacetFinder(const MeshView& mesh,
                std::span<const VertexId> weld,
                std::span<const std::uint32_t> labels);

    /// The facets of the mesh in its pose now. Preconditions: the triangles that it was made for,
    /// whose vertices are welded as then.
    Facets find(const MeshView& mesh, Executor& executor = Executor::serial()) const;

private:
    std::vector<Triangle> welded_;
    std::vector<HalfEdgeId> twins_;
    std::vector<std::uint32_t> labels_;
};

}  // namespace earshot::geometry
