// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include "earshot/bvh/quality.h"

#include <algorithm>
#include <utility>

namespace earshot::collision {

using geometry::Aabb;
using geometry::Triangle;
using geometry::Vec3;

namespace {

/// The BVHs of the meshes below one top-level tree. It may be deeper than bvh::kMaxDepth.
struct MergedBvh {
    bvh::Tree tree;
    /// The mesh of each node; kMixedMeshes for the nodes of the top-level tree.
    std::vector<std::uint32_t> tree_of_node;
};

/// Builds the top-level tree over the roots of the BVHs and copies their nodes below its leaves:
/// depth-first, siblings side by side. Primitives are numbered on from BVH to BVH.
class Merger {
public:
    explicit Merger(std::span<const bvh::Tree> trees) : trees_(trees) {
        std::uint32_t primitives = 0;
        std::size_t below_roots = 0;
        std::vector<geometry::Aabb> boxes;
        for (std::uint32_t i = 0; i < trees.size(); ++i) {
            first_primitive_.push_back(primitives);
            primitives += static_cast<std::uint32_t>(trees[i].primitives().size());
            if (!trees[i].nodes().empty()) {
                boxes.push_back(trees[i].nodes()[0].box);
                tree_of_box_.push_back(i);
                below_roots += trees[i].nodes().size() - 1;
            }
        }
        if (boxes.empty()) {
            return;
        }
        top_ = bvh::Tree::build(boxes, {.max_leaf_size = 1});
        nodes_.resize(top_.nodes().size() + below_roots);
        tree_of_node_.resize(nodes_.size(), SweptBvh::kMixedMeshes);
        primitives_.reserve(primitives);
        copy_top(0, 0);
    }

    MergedBvh merged() && {
        return {bvh::Tree::from_nodes(std::move(nodes_), std::move(primitives_)),
                std::move(tree_of_node_)};
    }

private:
    void copy_top(std::uint32_t source, std::uint32_t target) {
        const bvh::Node& node = top_.nodes()[source];
        if (node.is_leaf()) {
            copy_bvh(tree_of_box_[top_.primitives()[node.first]], target);
            return;
        }
        const std::uint32_t children = next_;
        next_ += 2;
        nodes_[target] = {.box = node.box, .first = children, .count = 0};
        copy_top(node.first, children);
        copy_top(node.first + 1, children + 1);
    }

    /// Copies a BVH: its root to `target`, beside the root's sibling, the other nodes behind.
    void copy_bvh(std::uint32_t tree, std::uint32_t target) {
        const std::span<const bvh::Node> nodes = trees_[tree].nodes();
        const std::uint32_t shift = next_ - 1;
        const auto slot = static_cast<std::uint32_t>(primitives_.size());
        for (std::uint32_t i = 0; i < nodes.size(); ++i) {
            const std::uint32_t to = i == 0 ? target : shift + i;
            nodes_[to] = nodes[i];
            nodes_[to].first += nodes[i].is_leaf() ? slot : shift;
            tree_of_node_[to] = tree;
        }
        for (const std::uint32_t primitive : trees_[tree].primitives()) {
            primitives_.push_back(first_primitive_[tree] + primitive);
        }
        next_ += static_cast<std::uint32_t>(nodes.size()) - 1;
    }

    std::span<const bvh::Tree> trees_;
    bvh::Tree top_;
    std::vector<std::uint32_t> tree_of_box_, first_primitive_;
    std::vector<bvh::Node> nodes_;
    std::vector<std::uint32_t> tree_of_node_, primitives_;
    std::uint32_t next_ = 1;
};

/// BVHs without nodes are left out.
MergedBvh merge(std::span<const bvh::Tree> trees) {
    return Merger(trees).merged();
}

/// The tree is refitted until its SAH cost exceeds that of the last build by this factor.
constexpr double kRebuildAtCost = 1.5;
constexpr std::size_t kGrain = 4096;

Aabb swept_box(const MovingCorners& corners, double margin) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [axis](const Vec3& p) { return p[axis]; };
        const auto& [a, b] = corners;
        const double lower = std::min({at(a[0]), at(a[1]), at(a[2]), at(b[0]), at(b[1]), at(b[2])});
        const double upper = std::max({at(a[0]), at(a[1]), at(a[2]), at(b[0]), at(b[1]), at(b[2])});
        // Adding the margin rounds once in double precision, possibly inward.
        const double padding = margin > 0.0 ? margin * (1.0 + 0x1p-40) : 0.0;
        box.lower[axis] = geometry::round_down(lower - padding);
        box.upper[axis] = geometry::round_up(upper + padding);
    }
    return box;
}

}  // namespace

bool SweptBvh::update(const MovingScene& scene, double margin, Executor& executor) {
    // 1. Bounding volumes of the step: boxes by triangle, DOP extents by vertex.
    const bool has_new_meshes = boxes_.size() != scene.triangles.size();
    boxes_.resize(scene.triangles.size());
    extents_.resize(scene.begin.size());
    executor.for_each(boxes_.size(), kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            boxes_[i] = swept_box(scene.corners_of(scene.triangles[i]),
                                  margin + scene.deviation_of(scene.triangles[i]));
        }
    });
    executor.for_each(extents_.size(), kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            extents_[i] = DopExtents(scene.begin[i], scene.end[i]);
        }
    });
    // 2. Refit, or build where meshes were added or the SAH cost has grown too much.
    bool is_new = has_new_meshes;
    if (!has_new_meshes) {
        tree_.refit(boxes_, executor);
        is_new = bvh::sah_cost(tree_) > kRebuildAtCost * cost_when_built_;
    }
    if (is_new) {
        build(scene, executor);
    }
    // 3. Copy what a traversal reads into the order of the leaves.
    fill_slots(scene, margin, executor);
    return is_new;
}

void SweptBvh::build(const MovingScene& scene, Executor& executor) {
    std::vector<bvh::Tree> trees;
    for (std::uint32_t mesh = 0; mesh < scene.meshes(); ++mesh) {
        const std::size_t first = scene.first_triangle[mesh];
        const std::size_t count = scene.first_triangle[mesh + 1] - first;
        trees.push_back(bvh::Tree::build(
            std::span(boxes_).subspan(first, count), {.builder = builder_}, executor));
    }
    MergedBvh merged = merge(trees);
    tree_ = std::move(merged.tree);
    mesh_of_node_ = std::move(merged.tree_of_node);
    cost_when_built_ = bvh::sah_cost(tree_);

    const std::span<const bvh::Node> nodes = tree_.nodes();
    slots_of_node_.resize(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {
        const bvh::Node& node = nodes[i];
        slots_of_node_[i] = node.is_leaf() ? SlotRange{node.first, node.first + node.count}
                                           : SlotRange{slots_of_node_[node.first].begin,
                                                       slots_of_node_[node.first + 1].end};
    }
}

void SweptBvh::fill_slots(const MovingScene& scene, double margin, Executor& executor) {
    slot_boxes_.resize(boxes_.size());
    dops_.resize(boxes_.size());
    executor.for_each(boxes_.size(), kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t slot = from; slot < to; ++slot) {
            const std::uint32_t id = triangle(static_cast<std::uint32_t>(slot));
            const Triangle& t = scene.triangles[id];
            slot_boxes_[slot] = boxes_[id];
            dops_[slot] = SweptDop(
                extents_[t[0]], extents_[t[1]], extents_[t[2]], margin + scene.deviation_of(t));
        }
    });
}

}  // namespace earshot::collision
