// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/discrete.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/collision/statistics.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::collision {

// The narrow phase at an instant: decides, in double precision, the pairs of triangles that a
// traversal of two BVHs finds.

/// A triangle's corners in the world.
inline Corners corners_of(const Body& body, geometry::TriangleId id) noexcept {
    const geometry::MeshView& mesh = body.shape.mesh();
    const geometry::Triangle& triangle = mesh.triangles[id];
    return {body.pose.apply(mesh.positions[triangle[0]]),
            body.pose.apply(mesh.positions[triangle[1]]),
            body.pose.apply(mesh.positions[triangle[2]])};
}

/// Caches the world corners of the last leaf: traversals ask for one leaf several times in a row.
class CachedLeaf {
public:
    explicit CachedLeaf(const Body& body) noexcept
        : pose_(body.pose), triangles_(body.shape.triangles()), corners_(body.shape.corners()) {}

    geometry::TriangleId triangle(std::uint32_t leaf) const noexcept { return triangles_[leaf]; }

    const Pose& pose() const noexcept { return pose_; }

    /// In the space of the mesh.
    const Corners& local_corners(std::uint32_t leaf) const noexcept { return corners_[leaf]; }

    /// In the world.
    const Corners& corners(std::uint32_t leaf) noexcept {
        if (leaf != leaf_) {
            leaf_ = leaf;
            for (std::size_t i = 0; i < 3; ++i) {
                world_corners_[i] = pose_.apply(corners_[leaf][i]);
            }
        }
        return world_corners_;
    }

private:
    const Pose& pose_;
    const std::span<const geometry::TriangleId> triangles_;
    const std::span<const Corners> corners_;
    std::uint32_t leaf_ = std::numeric_limits<std::uint32_t>::max();
    Corners world_corners_{};
};

/// Collects the pairs that intersect.
class ContactSearch {
public:
    enum class Query { first, all, all_of_one_mesh };

    ContactSearch(const Body& a, const Body& b, Query query) noexcept
        : triangles_(a.shape.mesh().triangles), a_(a), b_(b), query_(query) {}

    /// Adds a pair of leaves. Pairs are decided in batches. Returns whether the traversal must go
    /// on.
    bool add(std::uint32_t a, std::uint32_t b) {
        ++statistics.triangle_pairs;
        batch_[count_++] = {a, b};
        if (query_ == Query::first || count_ == batch_.size()) {
            decide();
        }
        return query_ != Query::first || found.empty();
    }

    /// Decides the pairs of the last batch.
    void decide();

    std::vector<TrianglePair> found;
    WorldStatistics statistics;  ///< box tests are counted by the traversal

private:
    using LeafPair = std::array<std::uint32_t, 2>;

    bool intersect_leaves(const LeafPair& leaves);
    void decide_batch(std::span<const LeafPair> pairs);

    const std::span<const geometry::Triangle> triangles_;
    CachedLeaf a_;
    CachedLeaf b_;
    Query query_;
    std::array<LeafPair, 32> batch_{};
    std::size_t count_ = 0;
};

/// Keeps the closest pair, of equally close ones the first. Precondition: no two triangles
/// intersect.
class DistanceSearch {
public:
    DistanceSearch(const Body& a, const Body& b) noexcept : a_(a), b_(b) {}

    void add(std::uint32_t a, std::uint32_t b) noexcept;

    /// Pairs of boxes farther apart than the root of this can be culled.
    float squared_bound() const noexcept { return squared_bound_; }

    MeshDistance best{};
    WorldStatistics statistics;  ///< box tests are counted by the traversal

private:
    CachedLeaf a_;
    CachedLeaf b_;
    float squared_bound_ = std::numeric_limits<float>::infinity();
    geometry::Vec3 direction_{0.0};  // unit vector between the best pair's points
};

}  // namespace earshot::collision
