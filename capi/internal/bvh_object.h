// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/exclusion_mask.h"

#include <utility>
#include <vector>

namespace earshot::capi {

/// A mesh and the hierarchy over it.
struct BvhObject : ObjectOf<ES_KIND_BVH> {
    BvhObject(geometry::Mesh the_mesh, const bvh::UpdateOptions& options, Executor& executor)
        : mesh(std::move(the_mesh)), tree(mesh.view(), options, executor) {}

    geometry::Mesh mesh;
    bvh::DeformableBvh tree;
    visibility::ExclusionMask excluded;

    /// Follows the mesh, whose positions have changed.
    bvh::UpdateReport update(double expected_queries, Executor& executor) {
        tree.expect_queries(expected_queries);
        return tree.update(mesh.view(), executor);
    }
};

}  // namespace earshot::capi
