// SPDX-License-Identifier: MIT
#include "earshot/bvh/mesh_bvh.h"

#include "earshot/bvh/internal/closest_point_search.h"

#include <array>
#include <cstddef>

namespace earshot::bvh {

using geometry::ClosestPoint;
using geometry::PreparedPoint;

namespace {

struct StackEntry {
    std::uint32_t child = 0;
    double squared_distance = 0.0;
};

/// Children of one node that are within a bound, the farthest first.
class SortedChildren {
public:
    void add(const StackEntry& child) noexcept {
        std::size_t place = count_++;
        for (; place > 0 && children_[place - 1].squared_distance < child.squared_distance;
             --place) {
            children_[place] = children_[place - 1];
        }
        children_[place] = child;
    }
    std::span<const StackEntry> all() const noexcept { return {children_.data(), count_}; }

private:
    std::array<StackEntry, WideNode::kWidth> children_;
    std::size_t count_ = 0;
};

SortedChildren children_within(const WideNode& node,
                               const PreparedPoint& point,
                               double bound) noexcept {
    SortedChildren children;
    for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
        const double squared = point.squared_distance(slot_box(node, slot));
        if (node.child[slot] != kNoChild && squared <= bound) {
            children.add({node.child[slot], squared});
        }
    }
    return children;
}

}  // namespace

// The search of closest_point_search.h, with up to eight children to a node.
std::optional<ClosestPoint> MeshBvh::closest_point(const geometry::Vec3& at,
                                                   double max_distance) const noexcept {
    const PreparedPoint point(at);
    if (tree_->nodes().empty() || !point.is_valid()) {
        return std::nullopt;
    }
    ClosestCollector closest(max_distance);
    std::array<StackEntry, kMaxWideStackSize> stack;
    std::size_t count = 0;
    double bound = PreparedPoint::squared_bound(max_distance);
    stack[count++] = {0, point.squared_distance(tree_->box())};
    while (count > 0) {
        const StackEntry current = stack[--count];
        // A box at the distance of the best triangle may hold one of lower index. Written so that
        // a bound that is not a number lets nothing pass.
        if (!(current.squared_distance <= bound)) {
            continue;
        }
        if (is_leaf(current.child)) {
            collect_leaf(tree_->leaf_triangles(current.child), mesh_, point, closest);
            bound = PreparedPoint::squared_bound(closest.max_distance());
            continue;
        }
        const SortedChildren children =
            children_within(tree_->nodes()[current.child], point, bound);
        for (const StackEntry& child : children.all()) {
            stack[count++] = child;
        }
    }
    return closest.best();
}

}  // namespace earshot::bvh
