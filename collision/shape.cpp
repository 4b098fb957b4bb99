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
using geometry::Vec3;

namespace {

constexpr std::size_t kGrain = 4096;
constexpr std::size_t kNodeGrain = 256;

// A larger piece of surface is rarely flat, and slabs of all levels would cost as much again.
constexpr std::uint32_t kMaxSlabTriangles = 2048;

// Collapsing the tree and making the slabs of a new topology, node visits of 20 ns per triangle.
constexpr double kCollapseCost = 2.0;

}  // namespace

/// Turns a binary tree with single triangles in its leaves into wide nodes: the largest child is
/// opened until there are eight, but what fits into one node stays together.
class ShapeCollapse {
public:
    explicit ShapeCollapse(Shape& shape)
        : nodes_(shape.bvh_.binary_tree().nodes()), shape_(shape), leaves_(nodes_.size()) {
        for (std::size_t i = leaves_.size(); i-- > 0;) {
            const Node& node = nodes_[i];
            // The leaves below a node are neighbours, but a leaf comes before those below its
            // sibling.
            leaves_[i] =
                node.is_leaf()
                    ? Leaves{node.first, 1}
                    : Leaves{std::min(leaves_[node.first].first, leaves_[node.first + 1].first),
                             leaves_[node.first].count + leaves_[node.first + 1].count};
        }
    }

    void place_all() {
        shape_.nodes_.clear();
        shape_.sources_.clear();
        shape_.nodes_.reserve(nodes_.size() / 3 + 2);
        shape_.sources_.reserve(nodes_.size() / 3 + 2);
        BoxNode root{};
        root.count = 1;
        shape_.nodes_.push_back(root);
        shape_.sources_.emplace_back(Shape::SlotSources{});
        place(0, 0, 0);
    }

private:
    /// Leaves are numbered as in the binary tree, where those below a node are neighbours.
    struct Leaves {
        std::uint32_t first = 0, count = 0;
    };

    void place(std::uint32_t wide, std::size_t slot, std::uint32_t source) {
        const std::uint32_t child = child_of(source);
        shape_.nodes_[wide].child[slot] = child;
        shape_.sources_[wide].node[slot] = source;
        shape_.sources_[wide].first_leaf[slot] = leaves_[source].first;
        shape_.sources_[wide].leaf_count[slot] = leaves_[source].count;
    }

    /// What stands for a binary node: a leaf, or a new wide node.
    std::uint32_t child_of(std::uint32_t index) {
        const Node& node = nodes_[index];
        if (node.is_leaf()) {
            return kTriangleFlag | node.first;
        }
        const auto wide = static_cast<std::uint32_t>(shape_.nodes_.size());
        shape_.nodes_.push_back(BoxNode{});
        shape_.sources_.emplace_back(Shape::SlotSources{});
        std::array<std::uint32_t, BoxNode::kWidth> slots{node.first, node.first + 1};
        std::uint32_t count = 2;
        const std::uint32_t fitting = leaves_[index].count <= BoxNode::kWidth ? 1 : BoxNode::kWidth;
        while (count < BoxNode::kWidth) {
            const std::size_t largest = largest_above(fitting, {slots.data(), count});
            if (largest == count) {
                break;
            }
            const std::uint32_t first = nodes_[slots[largest]].first;
            slots[largest] = first;
            slots[count++] = first + 1;
        }
        shape_.nodes_[wide].count = count;
        for (std::size_t i = 0; i < count; ++i) {
            place(wide, i, slots[i]);
        }
        return wide;
    }

    /// The largest slot of more triangles than that, or slots.size().
    std::size_t largest_above(std::uint32_t fitting, std::span<const std::uint32_t> slots) const {
        std::size_t largest = slots.size();
        double largest_area = -1.0;
        for (std::size_t i = 0; i < slots.size(); ++i) {
            const double area = nodes_[slots[i]].box.half_area();
            if (leaves_[slots[i]].count > fitting && area > largest_area) {
                largest_area = area;
                largest = i;
            }
        }
        return largest;
    }

    std::span<const Node> nodes_;
    Shape& shape_;
    std::vector<Leaves> leaves_;
};

namespace {

void set_box(BoxNode& node, std::size_t slot, const Aabb& box) {
    for (std::size_t k = 0; k < 3; ++k) {
        const auto lower = static_cast<double>(box.lower[k]);
        const auto upper = static_cast<double>(box.upper[k]);
        const auto centre = static_cast<float>(0.5 * (lower + upper));
        node.centre[k][slot] = centre;
        node.half[k][slot] = geometry::round_up(
            std::max(upper - static_cast<double>(centre), static_cast<double>(centre) - lower));
    }
}

/// The slab of a slot's triangles, given their corners and their normals, twice the areas long.
void set_slab(BoxNode& node,
              std::size_t slot,
              std::span<const Corners> corners,
              std::span<const Vec3> normals) {
    // Without a normal the slab is everything.
    if (normals.size() > kMaxSlabTriangles) {
        for (auto& component : node.normal) {
            component[slot] = 0.0F;
        }
        node.slab_centre[slot] = node.slab_half[slot] = 0.0F;
        return;
    }
    Vec3 sum(0.0);
    for (const Vec3& normal : normals) {
        sum += normal;
    }
    const double length = glm::length(sum);
    Vec3 normal(0.0);
    Vec3 centre(0.0);
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        // Not a number, or of a length that underflows: no slab.
        const double component = sum[k] / length;
        node.normal[axis][slot] = std::abs(component) <= 1.0 ? static_cast<float>(component) : 0.0F;
        normal[k] = static_cast<double>(node.normal[axis][slot]);
        centre[k] = static_cast<double>(node.centre[axis][slot]);
    }
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Corners& triangle : corners) {
        for (const Vec3& corner : triangle) {
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

}  // namespace

Shape Shape::build(const geometry::MeshView& mesh,
                   const bvh::BuildOptions& options,
                   Executor& executor) {
    const auto count = static_cast<double>(mesh.triangles.size());
    bvh::UpdateOptions update{
        .build = options, .queries_per_update = count, .topology_cost = kCollapseCost};
    update.build.max_leaf_size = 1;
    Shape shape;
    shape.bvh_ = bvh::DeformableBvh(bvh::triangle_boxes(mesh, executor), update, executor);
    shape.follow(mesh, executor);
    return shape;
}

bvh::UpdateReport Shape::update(const geometry::MeshView& mesh, Executor& executor) {
    const bvh::UpdateReport report = bvh_.update(bvh::triangle_boxes(mesh, executor), executor);
    follow(mesh, executor);
    return report;
}

void Shape::follow(const geometry::MeshView& mesh, Executor& executor) {
    mesh_ = mesh;
    const bvh::Tree& tree = bvh_.binary_tree();
    if (tree.nodes().empty()) {
        return;
    }
    // 1. Wide nodes of the present topology.
    if (version_ != bvh_.version()) {
        ShapeCollapse(*this).place_all();
        version_ = bvh_.version();
    }
    max_abs_coordinate_ = tree.nodes()[0].box.max_abs_coordinate();
    if (!(max_abs_coordinate_ <= kMaxCoordinate)) {
        throw Error("mesh", "has a coordinate beyond 2^60 m", "scale it down");
    }
    // 2. Corners and normals in the order of the leaves.
    const std::span<const geometry::TriangleId> triangle_of_leaf = triangles();
    corners_.resize(triangle_of_leaf.size());
    LargeArray<Vec3> normals;
    normals.resize(corners_.size());
    executor.for_each(corners_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            const Corners t = geometry::corners(mesh, triangle_of_leaf[leaf]);
            corners_[leaf] = t;
            normals[leaf] = glm::cross(t[1] - t[0], t[2] - t[0]);
        }
    });
    // 3. Boxes from the binary tree, and slabs.
    const std::span<const Corners> corners(corners_.data(), corners_.size());
    const std::span<const Vec3> all_normals(normals.data(), normals.size());
    executor.for_each(nodes_.size(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t slot = 0; slot < nodes_[i].count; ++slot) {
                const std::uint32_t first = sources_[i].first_leaf[slot];
                const std::uint32_t count = sources_[i].leaf_count[slot];
                set_box(nodes_[i], slot, tree.nodes()[sources_[i].node[slot]].box);
                set_slab(nodes_[i],
                         slot,
                         corners.subspan(first, count),
                         all_normals.subspan(first, count));
            }
        }
    });
}

}  // namespace earshot::collision
