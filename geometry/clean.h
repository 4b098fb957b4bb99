// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::geometry {

/// What the clean-up pass found. Counts of triangles refer to the mesh as it was read, counts of
/// edges to the welded mesh.
struct CleanReport {
    std::size_t triangles_read = 0;
    std::size_t vertices_read = 0;
    std::size_t vertices_welded = 0;       ///< vertices that coincided with an earlier one
    std::size_t degenerate_triangles = 0;  ///< dropped: a vertex repeated, or zero area
    std::size_t duplicate_triangles = 0;   ///< dropped: the same three corners as an earlier one
    std::size_t open_edges = 0;            ///< edges with one triangle (borders of holes)
    std::size_t holes = 0;                 ///< connected groups of open edges
    std::size_t non_manifold_edges = 0;    ///< edges with more than two triangles
    std::size_t t_junctions = 0;           ///< ends of open edges that lie inside another open edge
    friend bool operator==(const CleanReport&, const CleanReport&) = default;
};

/// A triangle that was dropped, and the one that takes part in its place.
struct DuplicateTriangle {
    TriangleId duplicate = 0;
    TriangleId kept = 0;
    friend bool operator==(const DuplicateTriangle&, const DuplicateTriangle&) = default;
};

/// Which triangles take part, and how their vertices coincide. The scene's own vertices and
/// triangle numbers stay as they are, so that reports name triangles in file order and a mesh that
/// moves can be evaluated as before.
struct CleanMesh {
    std::vector<VertexId> weld;    ///< per vertex: the first vertex at the same position
    std::vector<TriangleId> kept;  ///< ascending indices of the triangles that take part
    std::vector<DuplicateTriangle> duplicates;  ///< by the index of the duplicate
    CleanReport report;
};

/// Welds vertices whose positions are equal to the last bit (-0 equals +0), finds degenerate and
/// duplicate triangles, and counts what a modeller would want to mend. Triangles of zero area are
/// found by an exact test. A triangle is a duplicate of an earlier one if their corners, in some
/// order, are the same vertices or lie within coplanar_tolerance() of each other, as those of two
/// copies do that an export has transformed in single precision; but a triangle whose height is no
/// larger than a few tolerances repeats only the same vertices. A vertex lies inside an edge if it
/// is within coplanar_tolerance() of it (tolerance.h) and farther than that from its ends. O(n log
/// n), but for T-junctions where many long open edges run close to many vertices. Precondition:
/// indices in range, positions finite.
CleanMesh clean(const MeshView& mesh, Executor& executor = Executor::serial());

/// The clean-up of a mesh that moves: what a new pose leaves as it was is not found again.
class CleanMeshCache {
public:
    /// Cleans the mesh in its pose now. True if kept, duplicates and the welding of their vertices
    /// are those of the update before, which the next pose of an animation mostly leaves alone:
    /// that is cheaper to tell than to clean. Precondition as for clean(); the triangles of the
    /// first mesh.
    bool update(const MeshView& mesh, Executor& executor = Executor::serial());

    /// Without a report. The welding of vertices in no kept triangle may be that of another pose.
    const CleanMesh& clean() const noexcept { return clean_; }

    /// Takes about as long as clean(). Precondition: the mesh given last.
    CleanReport report(const MeshView& mesh, Executor& executor = Executor::serial()) const;

private:
    void clean_afresh(const MeshView& mesh, Executor& executor);
    bool holds_for(const MeshView& mesh, Executor& executor) const;

    CleanMesh clean_;
    std::vector<std::uint8_t> has_area_;   // per triangle
    std::vector<std::uint8_t> is_corner_;  // per vertex: of triangles that are no exact duplicates
    bool has_near_duplicates_ = false;
};

}  // namespace earshot::geometry
