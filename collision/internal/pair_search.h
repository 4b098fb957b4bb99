// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/discrete.h"
#include "earshot/collision/triangle_pair.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::collision {

// What searches over pairs of boxes do with the pairs of triangles that they find: the decisions,
// in double precision.

/// A triangle's corners in the world.
inline Corners corners_of(const Body& body, geometry::TriangleId id) noexcept {
    const geometry::MeshView& mesh = body.shape.mesh();
    const geometry::Triangle& triangle = mesh.triangles[id];
    return {body.pose.place(mesh.positions[triangle[0]]),
            body.pose.place(mesh.positions[triangle[1]]),
            body.pose.place(mesh.positions[triangle[2]])};
}

/// The corners of the triangle that was asked for last: searches ask for one several times on end.
class LastTriangle {
public:
    explicit LastTriangle(const Body& body) noexcept : body_(body) {}

    const Corners& corners(geometry::TriangleId id) noexcept {
        if (id != id_) {
            id_ = id;
            corners_ = corners_of(body_, id);
        }
        return corners_;
    }

private:
    const Body& body_;
    geometry::TriangleId id_ = std::numeric_limits<geometry::TriangleId>::max();
    Corners corners_{};
};

/// Collects the pairs that meet.
class ContactSearch {
public:
    enum class Wanted { first, all, all_of_one_mesh };

    ContactSearch(const Body& a, const Body& b, Wanted wanted) noexcept
        : triangles_(a.shape.mesh().triangles), a_(a), b_(b), wanted_(wanted) {}

    /// Returns whether the search goes on.
    bool add(geometry::TriangleId a, geometry::TriangleId b);

    std::vector<TrianglePair> found;

private:
    const std::span<const geometry::Triangle> triangles_;
    LastTriangle a_;
    LastTriangle b_;
    Wanted wanted_;
};

/// Keeps the nearest pair, of equally near ones the first. Precondition: no two triangles meet.
class DistanceSearch {
public:
    DistanceSearch(const Body& a, const Body& b) noexcept : a_(a), b_(b) {}

    void add(geometry::TriangleId a, geometry::TriangleId b) noexcept;

    /// Pairs of boxes farther apart, by this square, are of no interest.
    float squared_bound() const noexcept { return squared_bound_; }

    MeshDistance best{};

private:
    LastTriangle a_;
    LastTriangle b_;
    float squared_bound_ = std::numeric_limits<float>::infinity();
    geometry::Vec3 direction_{0.0};  // from the best pair's one point to the other, length 1
};

}  // namespace earshot::collision
