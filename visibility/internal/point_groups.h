// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// A hierarchy over points that may move. A node's box holds its points, and grows only when a
/// point leaves the box that it has of its own: then the versions of the node and of those above it
/// change.
class PointGroups {
public:
    /// Takes the points as they are now. False if the nodes are others than before.
    bool update(std::span<const geometry::Vec3> points, Executor& executor);

    std::span<const geometry::Vec3> points() const noexcept { return points_; }
    std::size_t point_count() const noexcept { return points_.size(); }
    std::span<const bvh::Node> nodes() const noexcept { return bvh_.binary_tree().nodes(); }

    /// The points, those of a node next to each other.
    std::span<const std::uint32_t> order() const noexcept { return order_; }
    /// The first of a node in order(), and the one after its last.
    std::uint32_t begin_of(std::uint32_t node) const noexcept { return begin_[node]; }
    std::uint32_t end_of(std::uint32_t node) const noexcept { return end_[node]; }
    std::size_t count_of(std::uint32_t node) const noexcept { return end_[node] - begin_[node]; }
    std::uint32_t version(std::uint32_t node) const noexcept { return versions_[node]; }

    /// The highest nodes of at most kMaxUnitPoints points, in the order of their points.
    std::span<const std::uint32_t> units() const noexcept { return units_; }

    static constexpr std::size_t kMaxUnitPoints = 64;

private:
    void rebuild(std::span<const geometry::Vec3> points, Executor& executor);
    void list_points();

    bvh::DeformableBvh bvh_;
    std::uint64_t topology_ = 0;
    std::vector<geometry::Vec3> points_;
    std::vector<geometry::Aabb> boxes_;                  // per point
    std::vector<geometry::Aabb> old_boxes_;              // per node, before an update
    std::vector<std::uint32_t> order_;                   // points, leaf after leaf
    std::vector<std::uint32_t> begin_, end_, versions_;  // per node
    std::vector<std::uint32_t> units_;
};

}  // namespace earshot::visibility
