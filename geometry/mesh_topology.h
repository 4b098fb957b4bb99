// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::geometry {

/// A loop of border edges of a surface: the rim of a hole, or the outline of an open sheet.
struct HoleLoop {
    /// Welded vertices in order. A cap with this winding continues the surface.
    std::vector<VertexId> rim;
    std::size_t open_edges = 0;  ///< edges of the rim that have one triangle; at least one
    Vec3 centre{0.0};            ///< centroid of the rim as a wire, metres
    Vec3 lower{0.0};             ///< of the rim's bounding box
    Vec3 upper{0.0};
    /// Unit normal of the cap, to the front of the surface; 0 where the area is 0.
    Vec3 normal{0.0};
    double rim_length = 0.0;  ///< metres
    double area = 0.0;        ///< square metres: length of the rim's vector area
    /// The loop is the whole border of a sheet that is nearly flat: it outlines a surface rather
    /// than a hole in one.
    bool is_outline = false;
    std::uint32_t island = 0;
};

/// A connected component: triangles that share edges, however many meet in one.
struct Island {
    std::size_t triangles = 0;
    TriangleId first_triangle = 0;
    double area = 0.0;  ///< square metres
    Vec3 lower{0.0};    ///< of its bounding box, metres
    Vec3 upper{0.0};
    bool is_closed = true;      ///< every edge has an even number of triangles
    bool is_orientable = true;  ///< every pair of neighbours can agree on a front side
    /// Vertices - edges + triangles, after non-manifold fans are split: 2 for each closed surface
    /// without handles.
    std::int64_t euler_characteristic = 0;
};

/// Two triangles at one place.
struct DoubledFace {
    TriangleId first = 0;
    TriangleId repeated = 0;  ///< takes no part in queries of a clean mesh
    bool is_reversed = false;
    friend bool operator==(const DoubledFace&, const DoubledFace&) = default;
};

/// A vertex of an open edge that lies inside another open edge, within coplanar_tolerance().
struct TJunction {
    VertexId vertex = 0;
    Vec3 position{0.0};
    friend bool operator==(const TJunction&, const TJunction&) = default;
};

/// A triangle whose height is below kMaxSliverHeight of its longest side.
struct Sliver {
    TriangleId triangle = 0;
    double height = 0.0;  ///< metres, over the longest side
    double length = 0.0;  ///< metres, of the longest side
    Vec3 centre{0.0};
};

/// The normal of a triangle of this height has a relative error a thousand times that of its
/// coordinates, and facets of such triangles say little about a wall.
inline constexpr double kMaxSliverHeight = 1e-3;

/// How the triangles of a mesh hang together.
struct MeshTopology {
    CleanMesh clean;
    std::vector<Island> islands;  ///< in the order of their first triangles
    /// Per triangle of the mesh; kNoIsland for those that clean-up drops.
    std::vector<std::uint32_t> island_of_triangle;
    std::vector<HoleLoop> holes;  ///< by their smallest rim vertex within the order of islands
    /// Triangles whose winding differs from that of the larger part of their neighbourhood, by
    /// area: the patch of triangles that are connected across edges of two. Ascending.
    std::vector<TriangleId> flipped;
    std::vector<DoubledFace> doubled;  ///< by the repeated triangle
    std::vector<TJunction> t_junctions;
    std::vector<Sliver> slivers;     ///< by triangle
    std::size_t split_vertices = 0;  ///< copies that splitting non-manifold fans has made

    static constexpr std::uint32_t kNoIsland = 0xffffffffU;
};

/// Whether this build has the library (OpenMesh) that find_topology() needs.
bool topology_available() noexcept;

/// Non-manifold edges are split before: of their triangles, pairs that continue each other best
/// stay neighbours (Gueziec et al. 2001, cutting and stitching), the others get vertices of their
/// own. All positions are those of the mesh, in double precision. O(n log n) but for T-junctions,
/// see clean(). Throws Error unless topology_available(). Preconditions as for clean().
MeshTopology find_topology(const MeshView& mesh, Executor& executor = Executor::serial());

}  // namespace earshot::geometry
