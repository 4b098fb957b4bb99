// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/exclusion_mask.h"

#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace earshot::capi {

/// A mesh and the hierarchy over it.
struct BvhObject : ObjectOf<ES_KIND_BVH> {
    BvhObject(geometry::Mesh the_mesh, const bvh::UpdateOptions& the_options, Executor& executor)
        : mesh(std::move(the_mesh)), options(the_options), tree(mesh.view(), options, executor) {}

    geometry::Mesh mesh;
    bvh::UpdateOptions options;
    bvh::DeformableBvh tree;
    visibility::ExclusionMask excluded;

    /// The tree for closest points, made when it is first asked for. Callable from many threads.
    const bvh::Tree& closest_point_tree(Executor& executor) const {
        const std::lock_guard lock(mutex_);
        if (!box_tree_) {
            box_tree_.emplace(bvh::triangle_boxes(mesh.view(), executor), options, executor);
        }
        return box_tree_->binary_tree();
    }

    /// Follows the mesh, whose positions have changed.
    bvh::UpdateReport update(double expected_queries, Executor& executor) {
        tree.expect_queries(expected_queries);
        if (box_tree_) {
            box_tree_->expect_queries(expected_queries);
            box_tree_->update(bvh::triangle_boxes(mesh.view(), executor), executor);
        }
        return tree.update(mesh.view(), executor);
    }

private:
    mutable std::mutex mutex_;
    mutable std::optional<bvh::DeformableBvh> box_tree_;
};

}  // namespace earshot::capi
