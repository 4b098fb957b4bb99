// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/internal/swept_forest.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::collision {

/// What the triangles of each leaf cover along a mean normal of theirs, at the beginning and at the
/// end of a step. Tells apart layers that lie close, which fixed directions do not.
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
    bool are_apart(const MovingScene& scene, std::uint32_t a, std::uint32_t b) const noexcept {
        const std::uint32_t one = leaf_of_node_[a], other = leaf_of_node_[b];
        return is_beside(scene, plates_[one], vertices_of_[other]) ||
               is_beside(scene, plates_[other], vertices_of_[one]);
    }

private:
    /// Of places along a normal, and the largest coordinate that they were taken from.
    struct Extent {
        double lower = 0.0, upper = 0.0, size = 0.0;
    };
    struct Plate {
        geometry::Vec3 origin{0.0}, normal{0.0};
        Extent begin, end;
        double length = 0.0;  // of the normal, as a sum of magnitudes
    };

    Plate plate(const MovingScene& scene, const SweptForest& forest, std::size_t leaf) const;
    Extent extent(std::span<const geometry::Vec3> points,
                  SlotRange vertices,
                  const Plate& plate) const noexcept;
    /// 1 or -1 if what has an extent lies beyond the plate to one side for sure, 0 if not.
    int side(const Extent& own, const Extent& other, double length) const noexcept;
    bool is_beside(const MovingScene& scene, const Plate& plate, SlotRange vertices) const noexcept;

    std::vector<std::uint32_t> leaf_of_node_;
    std::vector<std::uint32_t> nodes_;    // of each leaf
    std::vector<SlotRange> vertices_of_;  // of each leaf, within vertices_
    std::vector<geometry::VertexId> vertices_;
    std::vector<Plate> plates_;
    double margin_ = 0.0;
};

}  // namespace earshot::collision
