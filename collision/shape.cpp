// SPDX-License-Identifier: MIT
#include "earshot/collision/shape.h"

#include "earshot/base/error.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace earshot::collision {

using bvh::Node;
using geometry::Aabb;

namespace {

/// Turns a binary tree with single triangles in its leaves into wide nodes: the largest child is
/// opened until there are eight, but what fits into one node stays together.
class Collapse {
public:
    Collapse(const bvh::Tree& tree,
             LargeArray<BoxNode>& nodes,
             LargeArray<geometry::TriangleId>& triangles)
        : tree_(tree), nodes_(nodes), triangles_(triangles), counts_(tree.nodes().size()) {
        for (std::size_t i = counts_.size(); i-- > 0;) {
            const Node& node = tree.nodes()[i];
            counts_[i] = node.is_leaf() ? 1 : counts_[node.first] + counts_[node.first + 1];
        }
    }

    void place_all() {
        nodes_.reserve(tree_.nodes().size() / 3 + 2);
        triangles_.reserve(tree_.primitives().size());
        BoxNode root{};
        root.count = 1;
        nodes_.push_back(root);
        const std::uint32_t child = child_of(0);
        nodes_[0].child[0] = child;
    }

private:
    /// What stands for a binary node: a leaf, or a new wide node.
    std::uint32_t child_of(std::uint32_t index) {
        const Node& node = tree_.nodes()[index];
        if (node.is_leaf()) {
            const auto leaf = static_cast<std::uint32_t>(triangles_.size());
            triangles_.push_back(tree_.primitives()[node.first]);
            return kTriangleFlag | leaf;
        }
        const auto wide = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back(BoxNode{});
        std::array<std::uint32_t, BoxNode::kWidth> slots{node.first, node.first + 1};
        std::uint32_t count = 2;
        const std::uint32_t fitting = counts_[index] <= BoxNode::kWidth ? 1 : BoxNode::kWidth;
        while (count < BoxNode::kWidth) {
            const std::size_t largest = largest_above(fitting, {slots.data(), count});
            if (largest == count) {
                break;
            }
            const std::uint32_t first = tree_.nodes()[slots[largest]].first;
            slots[largest] = first;
            slots[count++] = first + 1;
        }
        nodes_[wide].count = count;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t child = child_of(slots[i]);
            nodes_[wide].child[i] = child;
        }
        return wide;
    }

    /// The largest slot of more triangles than that, or slots.size().
    std::size_t largest_above(std::uint32_t fitting, std::span<const std::uint32_t> slots) const {
        std::size_t largest = slots.size();
        double largest_area = -1.0;
        for (std::size_t i = 0; i < slots.size(); ++i) {
            const Node& node = tree_.nodes()[slots[i]];
            if (counts_[slots[i]] > fitting && node.box.half_area() > largest_area) {
                largest_area = node.box.half_area();
                largest = i;
            }
        }
        return largest;
    }

    const bvh::Tree& tree_;
    LargeArray<BoxNode>& nodes_;
    LargeArray<geometry::TriangleId>& triangles_;
    std::vector<std::uint32_t> counts_;  // of the triangles below
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

/// Slabs of a hierarchy, from the leaves up.
class Slabs {
public:
    Slabs(std::span<const Corners> corners, std::span<BoxNode> nodes)
        : corners_(corners), nodes_(nodes) {
        normals_.reserve(corners.size());
    }

    /// Fills the slots of a node and all below.
    void fill(std::uint32_t index) {
        BoxNode& node = nodes_[index];
        for (std::size_t slot = 0; slot < node.count; ++slot) {
            const std::size_t first = normals_.size();
            const std::uint32_t child = node.child[slot];
            if ((child & kTriangleFlag) == 0) {
                fill(child);
            } else {
                const auto& t = corners_[first];
                normals_.push_back(glm::cross(t[1] - t[0], t[2] - t[0]));
            }
            set_slot(node, slot, first);
        }
    }

private:
    /// The slab of all triangles from one on that have a normal.
    void set_slot(BoxNode& node, std::size_t slot, std::size_t first) const {
        geometry::Vec3 sum(0.0);
        for (std::size_t i = first; i < normals_.size(); ++i) {
            sum += normals_[i];
        }
        const double length = glm::length(sum);
        geometry::Vec3 normal(0.0);
        geometry::Vec3 centre(0.0);
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            // Not a number, or of a length that underflows: no slab.
            const double component = sum[k] / length;
            node.normal[axis][slot] =
                std::abs(component) <= 1.0 ? static_cast<float>(component) : 0.0F;
            normal[k] = static_cast<double>(node.normal[axis][slot]);
            centre[k] = static_cast<double>(node.centre[axis][slot]);
        }
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        for (std::size_t i = first; i < normals_.size(); ++i) {
            for (const geometry::Vec3& corner : corners_[i]) {
                const double height = glm::dot(normal, corner - centre);
                low = std::min(low, height);
                high = std::max(high, height);
            }
        }
        const auto middle = static_cast<float>(0.5 * (low + high));
        node.slab_centre[slot] = middle;
        node.slab_half[slot] = geometry::round_up(
            std::max(high - static_cast<double>(middle), static_cast<double>(middle) - low));
    }

    std::span<const Corners> corners_;
    std::span<BoxNode> nodes_;
    std::vector<geometry::Vec3> normals_;  // of the leaves so far, twice the areas long
};

}  // namespace

void Shape::set_slabs() {
    Slabs(corners_, {nodes_.data(), nodes_.size()}).fill(0);
}

Shape Shape::build(const geometry::MeshView& mesh,
                   const bvh::BuildOptions& options,
                   Executor& executor) {
    bvh::BuildOptions single = options;
    single.max_leaf_size = 1;
    const auto tree = bvh::Tree::build(bvh::triangle_boxes(mesh, executor), single, executor);
    Shape shape;
    shape.mesh_ = mesh;
    if (!tree.nodes().empty()) {
        Collapse(tree, shape.nodes_, shape.triangles_).place_all();
        shape.set_corners();
        shape.set_boxes();
        shape.set_slabs();
    }
    return shape;
}

void Shape::refit(const geometry::MeshView& mesh) {
    mesh_ = mesh;
    if (!nodes_.empty()) {
        set_corners();
        set_boxes();
        set_slabs();
    }
}

void Shape::set_corners() {
    corners_.resize(triangles_.size());
    for (std::size_t leaf = 0; leaf < corners_.size(); ++leaf) {
        const auto& [a, b, c] = mesh_.triangles[triangles_[leaf]];
        corners_[leaf] = {mesh_.positions[a], mesh_.positions[b], mesh_.positions[c]};
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
                for (const geometry::Vec3& corner : corners_[child & ~kTriangleFlag]) {
                    box.include(corner);
                }
            }
            set_slot(node, slot, box);
            boxes[i].include(box);
        }
    }
    max_abs_coordinate_ = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        max_abs_coordinate_ = std::max({max_abs_coordinate_,
                                        std::abs(static_cast<double>(boxes[0].lower[k])),
                                        std::abs(static_cast<double>(boxes[0].upper[k]))});
    }
    if (!(max_abs_coordinate_ <= kMaxCoordinate)) {
        throw Error("mesh", "has a coordinate beyond 2^60 m", "scale it down");
    }
}

}  // namespace earshot::collision
