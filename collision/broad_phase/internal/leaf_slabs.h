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

/// What the triangles of each leaf cover along a mean normal of theirs, at the beginning and at the
/// end of a step. Tells apart layers that lie close, which fixed directions do not. In single
/// precision, from the middle of the scene, with room for all rounding.
class LeafPlates {
public:
    /// Lists the vertices of the leaves of a new tree.
    void build(const MovingScene& scene, const SweptForest& forest);

    /// Follows the step. `margin`: see MotionSlabs.
    void update(const MovingScene& scene,
                const SweptForest& forest,
                double margin,
                Executor& executor);

    /// True only if no triangle of one leaf meets one of the other during the step. Precondition:
    /// nodes that are leaves.
    bool are_apart(std::uint32_t a, std::uint32_t b) const noexcept {
        const std::uint32_t one = leaf_of_node_[a], other = leaf_of_node_[b];
        return is_beside(plates_[one], blocks_of_[other]) ||
               is_beside(plates_[other], blocks_of_[one]);
    }

private:
    static constexpr std::size_t kLanes = 4;
    using Lanes = std::array<float, kLanes>;

    /// Four vertices of a leaf; the last of a leaf is repeated.
    struct Block {
        alignas(16) std::array<Lanes, 3> begin, end;
    };
    /// Of places along a normal.
    struct Extent {
        float lower = 0.0F, upper = 0.0F;
    };
    struct Plate {
        std::array<float, 3> normal{};  // the largest component is 1, or all are 0
        float room = 0.0F;              // that must be between what is apart
        Extent begin, end;
    };

    void place_vertices(const MovingScene& scene, std::size_t leaf);
    Plate plate(const MovingScene& scene, const SweptForest& forest, std::size_t leaf) const;
    Extent extent(std::array<Lanes, 3> Block::*time,
                  SlotRange blocks,
                  const std::array<float, 3>& normal) const noexcept;
    bool is_beside(const Plate& plate, SlotRange blocks) const noexcept;

    std::vector<std::uint32_t> leaf_of_node_;
    std::vector<std::uint32_t> nodes_;          // of each leaf
    std::vector<SlotRange> blocks_of_;          // of each leaf, within blocks_
    std::vector<geometry::VertexId> vertices_;  // of each block's lanes
    std::vector<Block> blocks_;
    std::vector<Plate> plates_;
    geometry::Vec3 origin_{0.0};
    float room_ = 0.0F;  // for the length of a normal, as a sum of magnitudes
};

}  // namespace earshot::collision
