// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/collision/broad_phase/internal/swept_dop.h"
#include "earshot/collision/internal/moving_scene.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::collision {

/// Places of the primitives of a tree, leaf after leaf.
struct SlotRange {
    std::uint32_t begin = 0, end = 0;
};

/// One tree over the swept triangles of all meshes, of which each has a subtree of its own. What is
/// asked of triangles during a search stands in the order of the leaves, in "slots", so that what
/// is asked together lies together.
class SweptForest {
public:
    /// For nodes above the meshes' own.
    static constexpr std::uint32_t kManyMeshes = std::numeric_limits<std::uint32_t>::max();

    explicit SweptForest(bvh::Builder builder = bvh::Builder::binned_sah) : builder_(builder) {}

    /// Follows the scene: refits, or builds anew where meshes were added or the tree has aged.
    /// Returns true if it was built. `margin` widens boxes, metres.
    bool update(const MovingScene& scene, double margin, Executor& executor);

    const bvh::Tree& tree() const noexcept { return tree_; }
    std::uint32_t mesh_of_node(std::uint32_t node) const noexcept { return mesh_of_node_[node]; }
    SlotRange slots_of_node(std::uint32_t node) const noexcept { return slots_of_node_[node]; }
    /// The triangle in a slot.
    std::uint32_t triangle(std::uint32_t slot) const noexcept { return tree_.primitives()[slot]; }
    const geometry::Aabb& box(std::uint32_t slot) const noexcept { return slot_boxes_[slot]; }
    const MotionSlabs& slabs(std::uint32_t slot) const noexcept { return slabs_[slot]; }

private:
    void build(const MovingScene& scene, Executor& executor);
    void fill_slots(const MovingScene& scene, double margin, Executor& executor);

    bvh::Builder builder_;
    bvh::Tree tree_;
    double cost_when_built_ = 0.0;
    std::vector<std::uint32_t> mesh_of_node_;
    std::vector<SlotRange> slots_of_node_;
    std::vector<geometry::Aabb> boxes_;  // by triangle
    std::vector<geometry::Aabb> slot_boxes_;
    std::vector<MotionPlaces> places_;  // by vertex
    std::vector<MotionSlabs> slabs_;    // by slot
};

}  // namespace earshot::collision
