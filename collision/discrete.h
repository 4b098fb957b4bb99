// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/shape.h"
#include "earshot/geometry/types.h"

#include <compare>
#include <limits>
#include <span>
#include <vector>

namespace earshot::collision {

// Contacts and distances at one instant. Triangles are surfaces: a mesh inside another does not
// intersect it. Everything is decided in world space, on the vertices that Pose::apply() gives, by
// intersect() and distance() of two triangles; BVHs only cull. So answers depend on the transformed
// triangles alone. All functions throw Error if a pose is not rigid (rotations may be off by 1e-9)
// and accept empty shapes.

/// A triangle of each of two meshes, or two of one mesh.
struct TrianglePair {
    geometry::TriangleId a = 0;
    geometry::TriangleId b = 0;

    friend auto operator<=>(const TrianglePair&, const TrianglePair&) = default;
};

/// Whether any triangle of a intersects one of b.
bool intersects(const Body& a, const Body& b);

/// All pairs of triangles that intersect, ascending, each once. The same for any executor.
std::vector<TrianglePair> find_contacts(const Body& a,
                                        const Body& b,
                                        Executor& executor = Executor::serial());

/// All pairs of triangles of one mesh that intersect beyond the features that they share,
/// ascending, each once, with a < b. Shared features are vertices of the same VertexId, and the
/// edge between two: triangles with one common vertex count if they have any other point in common,
/// those with a common edge if they overlap in an area, those with three common vertices always. A
/// triangle without area does not count with a triangle that it shares a vertex with.
std::vector<TrianglePair> find_self_contacts(const Body& body,
                                             Executor& executor = Executor::serial());

/// The intersection() of each pair, in their order. Precondition: they intersect.
std::vector<geometry::Segment> contact_segments(const Body& a,
                                                const Body& b,
                                                std::span<const TrianglePair> pairs);

/// How far apart two meshes are, and where.
struct MeshDistance {
    /// Metres, with the accuracy of TriangleDistance; 0 if and only if intersects(); infinite if a
    /// mesh has no triangles.
    double distance = std::numeric_limits<double>::infinity();
    /// The closest triangles, of equally close ones the first pair. Like the members below, left at
    /// its default if the distance is infinite, or 0 (find_contacts() then tells more).
    TrianglePair triangles{};
    geometry::Vec3 on_a{0.0};  ///< the closest points, metres
    geometry::Vec3 on_b{0.0};

    friend bool operator==(const MeshDistance&, const MeshDistance&) = default;
};

MeshDistance distance(const Body& a, const Body& b);

}  // namespace earshot::collision
