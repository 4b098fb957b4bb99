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

// What touches what, and how far apart things are, at one instant. Triangles are surfaces: a mesh
// inside another does not touch it. Everything is decided in the world, on vertices where
// Pose::apply() puts them, by intersect() and distance() of two triangles; hierarchies only leave
// out what is far away. So answers depend on the placed triangles alone. All functions throw Error
// if a pose is not rigid (rotations may be off by 1e-9) and work on empty shapes.

/// A triangle of each of two meshes, or two of one mesh.
struct TrianglePair {
    geometry::TriangleId a = 0;
    geometry::TriangleId b = 0;

    friend auto operator<=>(const TrianglePair&, const TrianglePair&) = default;
};

/// Whether any triangle of a meets one of b.
bool intersects(const Body& a, const Body& b);

/// All pairs of triangles that meet, ascending, each once. The same for any executor.
std::vector<TrianglePair> find_contacts(const Body& a,
                                        const Body& b,
                                        Executor& executor = Executor::serial());

/// All pairs of triangles of one mesh that meet in more than what they share, ascending, each once,
/// with a < b. What they share are vertices of the same VertexId, and the edge between two:
/// triangles with one vertex in common count if they have any other point in common, those with an
/// edge in common if they overlap in an area, those with all three vertices always. A triangle
/// without area counts with no triangle that it shares a vertex with.
std::vector<TrianglePair> find_self_contacts(const Body& body,
                                             Executor& executor = Executor::serial());

/// What intersection() says of each pair, in their order. Precondition: they meet.
std::vector<geometry::Segment> contact_segments(const Body& a,
                                                const Body& b,
                                                std::span<const TrianglePair> pairs);

/// How far apart two meshes are, and where.
struct MeshDistance {
    /// Metres, with the accuracy of TriangleDistance; 0 if and only if intersects(); infinite if a
    /// mesh has no triangles.
    double distance = std::numeric_limits<double>::infinity();
    /// The nearest triangles, of equally near ones the first pair. As what follows, left at its
    /// default if the distance is 0, when find_contacts() tells more, or infinite.
    TrianglePair triangles{};
    geometry::Vec3 on_a{0.0};  ///< the nearest points, metres
    geometry::Vec3 on_b{0.0};

    friend bool operator==(const MeshDistance&, const MeshDistance&) = default;
};

MeshDistance distance(const Body& a, const Body& b);

}  // namespace earshot::collision
