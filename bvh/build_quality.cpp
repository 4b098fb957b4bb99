// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/reinsertion.h"

namespace earshot::bvh {

Tree build_quality(std::span<const geometry::Aabb> boxes,
                   const BuildOptions& options,
                   Executor& executor) {
    Tree tree = build_binned_sah(boxes, options, executor);
    optimise_by_reinsertion(tree, {}, executor);
    return tree;
}

}  // namespace earshot::bvh
