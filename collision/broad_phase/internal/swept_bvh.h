// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/grouped_tree.h"
#include "earshot/collision/broad_phase/internal/changed_meshes.h"
#include "earshot/collision/broad_phase/internal/swept_dop.h"
#include "earshot/collision/internal/moving_scene.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

/// A range of slots: positions in the order of the primitives of a tree, leaf after leaf.
using SlotRange = IndexRange;

/// Swept-volume BVH: one tree over the boxes that cover each triangle during a step, with a subtree
/// per mesh. What a traversal reads of triangles stands in the order of the leaves, in "slots", so
/// that it reads consecutive memory.
class SweptBvh {
public:
    /// The mesh of a node of the top-level tree.
    static constexpr std::uint32_t kMixedMeshes = bvh::kMixedGroups;

    explicit SweptBvh(bvh::Builder builder = bvh::Builder::binned_sah) : builder_(builder) {}

    /// Follows the scene. Returns true if the topology has changed. `margin` pads boxes, metres.
    bool update(const MovingScene& scene, double margin, Executor& executor);

    /// What the last update did; nothing where meshes were added or removed.
    std::optional<bvh::UpdateAction> last_action() const noexcept { return last_action_; }

    /// Tells how many tests of boxes the search after the last update took.
    void expect_box_tests(std::uint64_t tests) noexcept {
        bvh_.expect_node_visits(static_cast<double>(tests));
    }

    const bvh::Tree& tree() const noexcept { return bvh_.binary_tree(); }
    std::uint32_t mesh_of_node(std::uint32_t node) const noexcept { return mesh_of_node_[node]; }
    SlotRange slots_of_node(std::uint32_t node) const noexcept { return slots_of_node_[node]; }
    SlotRange slots_of_mesh(std::uint32_t mesh) const noexcept { return slots_of_mesh_[mesh]; }
    /// The triangle in a slot.
    std::uint32_t triangle(std::uint32_t slot) const noexcept { return tree().primitives()[slot]; }
    const geometry::Aabb& box(std::uint32_t slot) const noexcept { return slot_boxes_[slot]; }
    const SweptDop& dop(std::uint32_t slot) const noexcept { return dops_[slot]; }

private:
    void find_meshes_and_slots(const MovingScene& scene);
    void fill_slots(const MovingScene& scene,
                    std::span<const SlotRange> slots,
                    double margin,
                    Executor& executor);

    bvh::Builder builder_;
    bvh::DeformableBvh bvh_;    // over the swept boxes, grouped by mesh
    std::uint64_t layout_ = 0;  // of the scene that it is over
    std::uint64_t version_ = 0;
    std::optional<bvh::UpdateAction> last_action_;
    std::vector<std::uint32_t> mesh_of_node_;
    std::vector<SlotRange> slots_of_node_, slots_of_mesh_;
    ChangedMeshes changed_meshes_;
    double margin_ = 0.0;                // of the boxes
    std::vector<geometry::Aabb> boxes_;  // by triangle
    std::vector<geometry::Aabb> slot_boxes_;
    std::vector<DopExtents> extents_;  // by vertex
    std::vector<SweptDop> dops_;       // by slot
};

}  // namespace earshot::collision
