// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/facet_tree.h"

#include "earshot/frustum/internal/frustum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::frustum {

using geometry::Aabb;

namespace {

/// A child of a wide node before it has an index: a subtree of the binary tree, or a facet.
struct Slot {
    Aabb box;
    std::uint32_t number = 0;  ///< of the binary node or of the facet
    bool is_facet = false;
};

/// The children of a wide node.
struct Slots {
    std::array<Slot, FacetNode::kWidth> slot;
    std::size_t count = 0;

    void add(const Slot& added) { slot[count++] = added; }
};

class Collapse {
public:
    Collapse(const bvh::Tree& tree, std::span<const Aabb> boxes) : tree_(tree), boxes_(boxes) {}

    /// The subtrees and facets that the wide node of a subtree has as children: the largest is
    /// opened as long as what is in it finds room, the first of equals.
    Slots children_of(std::uint32_t root) const {
        Slots slots;
        open({.box = {}, .number = root, .is_facet = false}, slots);
        for (;;) {
            std::size_t largest = slots.count;
            for (std::size_t i = 0; i < slots.count; ++i) {
                const bool fits = slots.count - 1 + size_of(slots.slot[i]) <= FacetNode::kWidth;
                if (!slots.slot[i].is_facet && fits &&
                    (largest == slots.count ||
                     slots.slot[i].box.half_area() > slots.slot[largest].box.half_area())) {
                    largest = i;
                }
            }
            if (largest == slots.count) {
                return slots;
            }
            const Slot opened = slots.slot[largest];
            slots.slot[largest] = slots.slot[--slots.count];
            open(opened, slots);
        }
    }

private:
    std::size_t size_of(const Slot& slot) const {
        const bvh::Node& node = tree_.nodes()[slot.number];
        return slot.is_facet ? 1 : node.is_leaf() ? node.count : 2;
    }

    void open(const Slot& slot, Slots& slots) const {
        const bvh::Node& node = tree_.nodes()[slot.number];
        for (std::uint32_t i = 0; i < size_of(slot); ++i) {
            if (node.is_leaf()) {
                const std::uint32_t facet = tree_.primitives()[node.first + i];
                if (!boxes_[facet].is_empty()) {
                    slots.add({boxes_[facet], facet, true});
                }
            } else {
                slots.add({tree_.nodes()[node.first + i].box, node.first + i, false});
            }
        }
    }

    const bvh::Tree& tree_;
    std::span<const Aabb> boxes_;
};

void set_box(FacetNode& node, std::size_t slot, const Aabb& box) {
    for (std::size_t k = 0; k < 3; ++k) {
        node.lower[k][slot] = static_cast<double>(box.lower[k]);
        node.upper[k][slot] = static_cast<double>(box.upper[k]);
    }
}

}  // namespace

FacetTree::FacetTree(const bvh::Tree& tree, std::span<const Aabb> boxes) {
    if (tree.nodes().empty()) {
        return;
    }
    const Collapse collapse(tree, boxes);
    std::vector<std::uint32_t> roots = {0};  // per wide node: the subtree that it holds
    for (std::size_t i = 0; i < roots.size(); ++i) {
        const Slots slots = collapse.children_of(roots[i]);
        FacetNode node;
        for (std::size_t slot = 0; slot < slots.count; ++slot) {
            const Slot& child = slots.slot[slot];
            set_box(node, slot, child.box);
            node.child[slot] = child.is_facet ? child.number | FacetNode::kFacetFlag
                                              : static_cast<std::uint32_t>(roots.size());
            node.used |= 1U << slot;
            if (!child.is_facet) {
                roots.push_back(child.number);
            }
        }
        nodes_.push_back(node);
    }
}

FrustumBoxTest::FrustumBoxTest(const Frustum& frustum,
                               const HalfSpaces& half_spaces,
                               double position_error) noexcept
    : grid_side(frustum.cells), slack(kCellSlack) {
    for (std::size_t i = 0; i < kHalfSpaces; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            normal[i][k] = half_spaces.positive[k][i] + half_spaces.negative[k][i];
            farthest[i][k] = FacetNode::kWidth * (normal[i][k] > 0.0 ? 3 + k : k);
        }
        offset[i] = half_spaces.offset[i];
    }
    const geometry::Vec3* directions[] = {&frustum.right, &frustum.up, &frustum.forward};
    for (int k = 0; k < 3; ++k) {
        apex[k] = frustum.apex[k];
        for (int axis = 0; axis < 3; ++axis) {
            axes[axis][k] = (*directions[axis])[k];
            abs_axes[axis][k] = std::abs(axes[axis][k]);
        }
    }
    for (int k = 0; k < 2; ++k) {
        grid_lower[k] = frustum.rect.lower[k];
        cells_per_unit[k] = grid_side / (frustum.rect.upper[k] - frustum.rect.lower[k]);
    }
    slack_by_depth =
        kProjectionErrorFactor * position_error * std::max(cells_per_unit[0], cells_per_unit[1]);
}

}  // namespace earshot::frustum
