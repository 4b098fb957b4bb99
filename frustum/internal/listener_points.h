// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/traverse.h"
#include "earshot/frustum/internal/frustum.h"

#include <span>
#include <vector>

namespace earshot::frustum {

/// Many listeners in a hierarchy, to be looked up by position.
class ListenerPoints {
public:
    explicit ListenerPoints(std::span<const geometry::Vec3> points) {
        std::vector<geometry::Aabb> boxes(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            boxes[i].include(points[i]);
        }
        bvh_ = bvh::DeformableBvh(boxes);
    }

    /// Calls visit(index) for a superset of the listeners in a frustum, in an order that depends on
    /// the points alone.
    template <typename Visit>
    void visit_in(const BoxCull& cull, Visit&& visit) const {
        bvh::traverse(
            bvh_.binary_tree(),
            [&](const bvh::Node& node) { return cull.may_overlap(node.box); },
            [&](std::uint32_t listener) {
                visit(listener);
                return true;
            });
    }

private:
    bvh::DeformableBvh bvh_;
};

}  // namespace earshot::frustum
