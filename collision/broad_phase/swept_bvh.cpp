// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include "earshot/bvh/quality.h"
#include "earshot/collision/broad_phase/internal/joined_trees.h"

#include <algorithm>

namespace earshot::collision {

using geometry::Aabb;
using geometry::Triangle;
using geometry::Vec3;

namespace {

/// A refitted tree is kept until its cost has grown by this factor.
constexpr double kRebuildAtCost = 1.5;
constexpr std::size_t kGrain = 4096;

Aabb swept_box(const MovingCorners& corners, double margin) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [axis](const Vec3& p) { return p[axis]; };
        const auto& [a, b] = corners;
        const double lower = std::min({at(a[0]), at(a[1]), at(a[2]), at(b[0]), at(b[1]), at(b[2])});
        const double upper = std::max({at(a[0]), at(a[1]), at(a[2]), at(b[0]), at(b[1]), at(b[2])});
        // A margin is added in double precision, which may round the wrong way once.
        const double room = margin > 0.0 ? margin * (1.0 + 0x1p-40) : 0.0;
        box.lower[axis] = geometry::round_down(lower - room);
        box.upper[axis] = geometry::round_up(upper + room);
    }
    return box;
}

}  // namespace

bool SweptForest::update(const MovingScene& scene, double margin, Executor& executor) {
    const bool has_new_meshes = boxes_.size() != scene.triangles.size();
    boxes_.resize(scene.triangles.size());
    places_.resize(scene.begin.size());
    executor.for_each(boxes_.size(), kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            boxes_[i] = swept_box(scene.corners_of(scene.triangles[i]), margin);
        }
    });
    executor.for_each(places_.size(), kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            places_[i] = MotionPlaces(scene.begin[i], scene.end[i]);
        }
    });
    bool is_new = has_new_meshes;
    if (!has_new_meshes) {
        tree_.refit(boxes_, executor);
        is_new = bvh::sah_cost(tree_) > kRebuildAtCost * cost_when_built_;
    }
    if (is_new) {
        build(scene, executor);
    }
    fill_slots(scene, margin, executor);
    return is_new;
}

void SweptForest::build(const MovingScene& scene, Executor& executor) {
    std::vector<bvh::Tree> trees;
    for (std::uint32_t mesh = 0; mesh < scene.meshes(); ++mesh) {
        const std::size_t first = scene.first_triangle[mesh];
        const std::size_t count = scene.first_triangle[mesh + 1] - first;
        trees.push_back(bvh::Tree::build(
            std::span(boxes_).subspan(first, count), {.builder = builder_}, executor));
    }
    JoinedTrees joined = join(trees);
    tree_ = std::move(joined.tree);
    mesh_of_node_ = std::move(joined.tree_of_node);
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

void SweptForest::fill_slots(const MovingScene& scene, double margin, Executor& executor) {
    slot_boxes_.resize(boxes_.size());
    slabs_.resize(boxes_.size());
    executor.for_each(boxes_.size(), kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t slot = from; slot < to; ++slot) {
            const std::uint32_t id = triangle(static_cast<std::uint32_t>(slot));
            const Triangle& t = scene.triangles[id];
            slot_boxes_[slot] = boxes_[id];
            slabs_[slot] = MotionSlabs(places_[t[0]], places_[t[1]], places_[t[2]], margin);
        }
    });
}

}  // namespace earshot::collision
