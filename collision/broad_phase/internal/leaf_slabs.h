// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/internal/moving_scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace earshot::collision {

/// Per-leaf separating slabs: the extents of each leaf's triangles along their mean normal, at the
/// beginning and at the end of a step. They separate layers that lie close, which fixed directions
/// do not. In single precision, relative to a point near the middle of the scene, with bounded
/// rounding error.
class LeafSlabs {
public:
    /// Lists the vertices of the leaves of a new tree.
    void build(const MovingScene& scene, const SweptBvh& swept_bvh);

    /// Follows the step. `margin` as in SweptDop.
    void update(const MovingScene& scene,
                const SweptBvh& swept_bvh,
                double margin,
                Executor& executor);

    /// True only if no triangle of one leaf intersects one of the other during the step.
    /// Precondition: both nodes are leaves.
    bool disjoint(std::uint32_t a, std::uint32_t b) const noexcept {
        const std::uint32_t one = leaf_of_node_[a], other = leaf_of_node_[b];
        return separates(leaf_slabs_[one], blocks_of_[other]) ||
               separates(leaf_slabs_[other], blocks_of_[one]);
    }

private:
    static constexpr std::size_t kLanes = 4;
    using Lanes = std::array<float, kLanes>;

    /// Four vertices of a leaf, the last one repeated to fill up.
    struct Block {
        alignas(16) std::array<Lanes, 3> begin, end;
    };
    /// An interval of projections onto a normal.
    struct Extent {
        float lower = 0.0F, upper = 0.0F;
    };
    struct Slab {
        std::array<float, 3> normal{};  // the largest component is 1, or all are 0
        float length = 0.0F;            // the sum of its absolute components, rounded up
        Extent begin, end;
    };

    void follow_box(const geometry::Aabb& box, double margin);
    void copy_vertices(const MovingScene& scene, std::size_t leaf);
    Slab slab(const MovingScene& scene, const SweptBvh& swept_bvh, std::size_t leaf) const;
    Extent extent(std::array<Lanes, 3> Block::*time,
                  SlotRange blocks,
                  const std::array<float, 3>& normal) const noexcept;
    bool separates(const Slab& slab, SlotRange blocks) const noexcept;

    std::vector<std::uint32_t> leaf_of_node_;
    std::vector<std::uint32_t> nodes_;          // of each leaf
    std::vector<SlotRange> blocks_of_;          // of each leaf, within blocks_
    std::vector<geometry::VertexId> vertices_;  // of each block's lanes
    std::vector<Block> blocks_;
    std::vector<Slab> leaf_slabs_;
    std::vector<IndexRange> leaves_of_mesh_;
    ChangedMeshes changed_meshes_;
    geometry::Vec3 origin_{0.0};
    float error_ = 0.0F;  // of projections onto a normal whose absolute components sum to 1
};

}  // namespace earshot::collision
