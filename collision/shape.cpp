// SPDX-License-Identifier: MIT
#include "earshot/collision/shape.h"

#include "earshot/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace earshot::collision {

using bvh::Node;
using geometry::Aabb;

namespace {

/// Turns a binary tree with single triangles in its leaves into wide nodes: the largest child is
/// opened until there are eight.
class Collapse {
public:
    Collapse(const bvh::Tree& tree, LargeArray<BoxNode>& nodes) : tree_(tree), nodes_(nodes) {}

    void place_all() {
        nodes_.reserve(tree_.nodes().size() / 3 + 2);
        BoxNode root{};
        root.count = 1;
        nodes_.push_back(root);
        const std::uint32_t child = child_of(0);
        nodes_[0].child[0] = child;
    }

private:
    /// What stands for a binary node: its triangle, or a new wide node.
    std::uint32_t child_of(std::uint32_t index) {
        const Node& node = tree_.nodes()[index];
        if (node.is_leaf()) {
            return kTriangleFlag | tree_.primitives()[node.first];
        }
        const auto place = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back(BoxNode{});
        std::array<std::uint32_t, BoxNode::kWidth> slots{node.first, node.first + 1};
        std::uint32_t count = 2;
        while (count < BoxNode::kWidth) {
            const std::size_t largest = largest_inner({slots.data(), count});
            if (largest == count) {
                break;
            }
            const std::uint32_t first = tree_.nodes()[slots[largest]].first;
            slots[largest] = first;
            slots[count++] = first + 1;
        }
        nodes_[place].count = count;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t child = child_of(slots[i]);
            nodes_[place].child[i] = child;
        }
        return place;
    }

    /// slots.size() if there is none.
    std::size_t largest_inner(std::span<const std::uint32_t> slots) const {
        std::size_t largest = slots.size();
        double most = -1.0;
        for (std::size_t i = 0; i < slots.size(); ++i) {
            const Node& node = tree_.nodes()[slots[i]];
            if (!node.is_leaf() && node.box.half_area() > most) {
                most = node.box.half_area();
                largest = i;
            }
        }
        return largest;
    }

    const bvh::Tree& tree_;
    LargeArray<BoxNode>& nodes_;
};

void set_slot(BoxNode& node, std::size_t slot, const Aabb& box) {
    for (std::size_t k = 0; k < 3; ++k) {
        const auto lower = static_cast<double>(box.lower[k]);
        const auto upper = static_cast<double>(box.upper[k]);
        const auto centre = static_cast<float>(0.5 * (lower + upper));
        node.centre[k][slot] = centre;
        node.half[k][slot] = geometry::round_up(
            std::max(upper - static_cast<double>(centre), static_cast<double>(centre) - lower));
    }
}

}  // namespace

Shape Shape::build(const geometry::MeshView& mesh,
                   const bvh::BuildOptions& options,
                   Executor& executor) {
    bvh::BuildOptions single = options;
    single.leaf_size = 1;
    const auto tree = bvh::Tree::build(bvh::triangle_boxes(mesh, executor), single, executor);
    Shape shape;
    shape.mesh_ = mesh;
    if (!tree.nodes().empty()) {
        Collapse(tree, shape.nodes_).place_all();
        shape.set_boxes();
    }
    return shape;
}

void Shape::refit(const geometry::MeshView& mesh) {
    mesh_ = mesh;
    if (!nodes_.empty()) {
        set_boxes();
    }
}

void Shape::set_boxes() {
    std::vector<Aabb> boxes(nodes_.size());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        BoxNode& node = nodes_[i];
        for (std::size_t slot = 0; slot < node.count; ++slot) {
            const std::uint32_t child = node.child[slot];
            Aabb box;
            if ((child & kTriangleFlag) == 0) {
                box = boxes[child];
            } else {
                for (const geometry::VertexId vertex : mesh_.triangles[child & ~kTriangleFlag]) {
                    box.include(mesh_.positions[vertex]);
                }
            }
            set_slot(node, slot, box);
            boxes[i].include(box);
        }
    }
    reach_ = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        reach_ = std::max({reach_,
                           std::abs(static_cast<double>(boxes[0].lower[k])),
                           std::abs(static_cast<double>(boxes[0].upper[k]))});
    }
    if (!(reach_ <= kReachLimit)) {
        throw Error("mesh", "has a coordinate beyond 2^60 m", "scale it down");
    }
}

}  // namespace earshot::collision
