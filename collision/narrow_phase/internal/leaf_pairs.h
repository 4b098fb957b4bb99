// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/discrete.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"

#include <array>
#include <cstddef>
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
    return {body.pose.apply(mesh.positions[triangle[0]]),
            body.pose.apply(mesh.positions[triangle[1]]),
            body.pose.apply(mesh.positions[triangle[2]])};
}

/// The corners of the leaf that was asked for last: searches ask for one several times on end.
class LastLeaf {
public:
    explicit LastLeaf(const Body& body) noexcept
        : pose_(body.pose), triangles_(body.shape.triangles()), corners_(body.shape.corners()) {}

    geometry::TriangleId triangle(std::uint32_t leaf) const noexcept { return triangles_[leaf]; }

    const Pose& pose() const noexcept { return pose_; }

    /// Where the mesh has them.
    const Corners& own_corners(std::uint32_t leaf) const noexcept { return corners_[leaf]; }

    /// Where they stand.
    const Corners& corners(std::uint32_t leaf) noexcept {
        if (leaf != leaf_) {
            leaf_ = leaf;
            for (std::size_t i = 0; i < 3; ++i) {
                placed_[i] = pose_.apply(corners_[leaf][i]);
            }
        }
        return placed_;
    }

private:
    const Pose& pose_;
    const std::span<const geometry::TriangleId> triangles_;
    const std::span<const Corners> corners_;
    std::uint32_t leaf_ = std::numeric_limits<std::uint32_t>::max();
    Corners placed_{};
};

/// Collects the pairs that meet.
class ContactSearch {
public:
    enum class Wanted { first, all, all_of_one_mesh };

    ContactSearch(const Body& a, const Body& b, Wanted wanted) noexcept
        : triangles_(a.shape.mesh().triangles), a_(a), b_(b), wanted_(wanted) {}

    /// Takes leaves. Returns whether the search goes on. Pairs may wait for others.
    bool add(std::uint32_t a, std::uint32_t b) {
        waiting_[count_++] = {a, b};
        if (wanted_ == Wanted::first || count_ == waiting_.size()) {
            decide();
        }
        return wanted_ != Wanted::first || found.empty();
    }

    /// Decides the pairs that wait still.
    void decide();

    std::vector<TrianglePair> found;

private:
    using LeafPair = std::array<std::uint32_t, 2>;

    bool meets(const LeafPair& leaves);
    void decide_lanes_of(std::span<const LeafPair> pairs);

    const std::span<const geometry::Triangle> triangles_;
    LastLeaf a_;
    LastLeaf b_;
    Wanted wanted_;
    std::array<LeafPair, 32> waiting_{};
    std::size_t count_ = 0;
};

/// Keeps the nearest pair, of equally near ones the first. Precondition: no two triangles meet.
class DistanceSearch {
public:
    DistanceSearch(const Body& a, const Body& b) noexcept : a_(a), b_(b) {}

    void add(std::uint32_t a, std::uint32_t b) noexcept;

    /// Pairs of boxes farther apart, by this square, are of no interest.
    float squared_bound() const noexcept { return squared_bound_; }

    MeshDistance best{};

private:
    LastLeaf a_;
    LastLeaf b_;
    float squared_bound_ = std::numeric_limits<float>::infinity();
    geometry::Vec3 direction_{0.0};  // from the best pair's one point to the other, length 1
};

}  // namespace earshot::collision
