// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include <algorithm>

namespace earshot::collision {

using geometry::Aabb;
using geometry::Triangle;
using geometry::Vec3;

namespace {

// Node visits of 20 ns per triangle that a change of topology costs beside a new tree: leaf slabs,
// contours of normal cones, and a traversal from the root.
constexpr double kTopologyCost = 20.0;

constexpr std::size_t kGrain = 4096;

Aabb swept_box(const MovingCorners& corners, double margin) {
    Aabb box;
    for (std::uint8_t axis = 0; axis < 3; ++axis) {
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
    // 1. Bounding volumes of the step, of meshes that do not move as in the last step: boxes by
    // triangle, DOP extents by vertex.
    if (layout_ != scene.layout || margin_ != margin) {
        changed_meshes_.reset();
        margin_ = margin;
    }
    const std::vector<std::uint32_t> changed = changed_meshes_.take(scene);
    boxes_.resize(scene.triangles.size());
    extents_.resize(scene.begin.size());
    for_each_index(
        ranges_of(changed, [&](std::uint32_t mesh) { return scene.triangle_range(mesh); }),
        kGrain,
        executor,
        [&](std::uint32_t i) {
            boxes_[i] = swept_box(scene.corners_of(scene.triangles[i]),
                                  margin + scene.deviation_of(scene.triangles[i]));
        });
    for_each_index(
        ranges_of(changed, [&](std::uint32_t mesh) { return scene.vertex_range(mesh); }),
        kGrain,
        executor,
        [&](std::uint32_t i) { extents_[i] = DopExtents(scene.begin[i], scene.end[i]); });
    // 2. The tree over the boxes.
    if (layout_ != scene.layout) {
        layout_ = scene.layout;
        last_action_.reset();
        bvh_ = bvh::DeformableBvh(
            boxes_,
            {.build = {.builder = builder_},
             .queries_per_update = 0.0,  // until a search has told
             .topology_cost = kTopologyCost,
             .group_ends = {scene.first_triangle.begin() + 1, scene.first_triangle.end()}},
            executor);
        version_ = 0;
    } else {
        last_action_ = bvh_.update(boxes_, executor).action;
    }
    const bool is_new = version_ != bvh_.version();
    if (is_new) {
        version_ = bvh_.version();
        find_meshes_and_slots(scene);
    }
    // 3. Copy what a traversal reads into the order of the leaves.
    const IndexRange all_slots{0, static_cast<std::uint32_t>(boxes_.size())};
    fill_slots(scene,
               is_new ? std::vector{all_slots}
                      : ranges_of(changed, [&](std::uint32_t mesh) { return slots_of_mesh(mesh); }),
               margin,
               executor);
    return is_new;
}

void SweptBvh::find_meshes_and_slots(const MovingScene& scene) {
    mesh_of_node_ = bvh::groups_of_nodes(tree(), std::span(scene.first_triangle).subspan(1));
    const std::span<const bvh::Node> nodes = tree().nodes();
    slots_of_node_.resize(nodes.size());
    slots_of_mesh_.assign(scene.meshes(), {});
    for (std::size_t i = nodes.size(); i-- > 0;) {
        const bvh::Node& node = nodes[i];
        if (node.is_leaf()) {
            slots_of_node_[i] = {node.first, node.first + node.count};
            continue;
        }
        // The slots below a node are neighbours, but those of a leaf may come before those below
        // its sibling.
        const SlotRange& left = slots_of_node_[node.first];
        const SlotRange& right = slots_of_node_[node.first + 1];
        slots_of_node_[i] = {std::min(left.begin, right.begin), std::max(left.end, right.end)};
    }
    // Parents stand before their children: the last node visited is the root of the mesh's subtree.
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (mesh_of_node_[i] != kMixedMeshes) {
            slots_of_mesh_[mesh_of_node_[i]] = slots_of_node_[i];
        }
    }
}

void SweptBvh::fill_slots(const MovingScene& scene,
                          std::span<const SlotRange> slots,
                          double margin,
                          Executor& executor) {
    slot_boxes_.resize(boxes_.size());
    dops_.resize(boxes_.size());
    for_each_index(slots, kGrain, executor, [&](std::uint32_t slot) {
        const std::uint32_t id = triangle(slot);
        const Triangle& t = scene.triangles[id];
        slot_boxes_[slot] = boxes_[id];
        dops_[slot] = SweptDop(
            extents_[t[0]], extents_[t[1]], extents_[t[2]], margin + scene.deviation_of(t));
    });
}

}  // namespace earshot::collision
