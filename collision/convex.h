// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/shape.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

// Penetration depth of solids. Surfaces do not tell what is inside; closed convex ones do.

/// A convex solid by its vertices, face normals and edges, in the space of its mesh.
struct ConvexPart {
    /// An edge that the faces of two normals share.
    struct Edge {
        std::array<std::uint32_t, 2> vertices{};
        std::array<std::uint32_t, 2> normals{};
    };

    std::vector<geometry::Vec3> vertices;
    std::vector<geometry::Vec3> normals;  ///< unit, outward, of the triangles
    std::vector<Edge> edges;              ///< but for those between coplanar triangles
};

/// The convex solids that a mesh consists of, one per component that is connected by edges, in the
/// order of their first triangles; if the surface is not closed as it is, after weld(). Empty if
/// the mesh has no triangles, or if any component is not closed and oriented (every edge in two
/// triangles, once in each direction), has no volume, or is not convex: no vertex may lie more than
/// 1e-6 of the component's size outside of the plane of one of its triangles. Triangles that point
/// inwards throughout are taken the other way round. O(triangles * vertices) of each component.
std::vector<ConvexPart> convex_parts(const geometry::MeshView& mesh);

/// The shortest translation that separates two solids.
struct SolidDepth {
    double depth = 0.0;        ///< metres; 0 where they touch
    geometry::Vec3 move{0.0};  ///< of a, of that length, metres; after it the solids only touch
    std::uint32_t part_a = 0;  ///< which parts these are
    std::uint32_t part_b = 0;
};

/// The penetration depth of two convex solids, empty if they are disjoint: the minimum of the
/// extents' overlap over all directions, which is found at a face normal of the Minkowski
/// difference of the two: a face normal of either solid, or the cross product of an edge of each
/// whose arcs intersect on the Gauss map (Cameron and Culley 1986). In double precision: never less
/// than the true depth by more than 2^-44 of the size of both, and as close to it for solids that
/// are exactly convex and whose triangles are not so thin that rounding turns their normals; of
/// solids convex within the tolerance of convex_parts(), that of their hulls within the tolerance.
/// Of equally short translations the first by faces of a, faces of b, edges. O(edges of a * edges
/// of b).
std::optional<SolidDepth> penetration_depth(const ConvexPart& a,
                                            const Pose& pose_a,
                                            const ConvexPart& b,
                                            const Pose& pose_b);

/// The deepest of all pairs of a part of one mesh and a part of the other, of equally deep ones the
/// first. The translation separates these two parts: of meshes of one part each, the meshes.
std::optional<SolidDepth> penetration_depth(std::span<const ConvexPart> a,
                                            const Pose& pose_a,
                                            std::span<const ConvexPart> b,
                                            const Pose& pose_b);

/// The deepest of all pairs of parts of one mesh.
std::optional<SolidDepth> self_penetration_depth(std::span<const ConvexPart> parts,
                                                 const Pose& pose);

}  // namespace earshot::collision
