// SPDX-License-Identifier: MIT
#include "earshot/bvh/tree.h"

#include "earshot/base/error.h"
#include "earshot/bvh/internal/builders.h"
#include "earshot/geometry/vector.h"

#include <cmath>
#include <string>
#include <utility>

namespace earshot::bvh {
namespace {

void check(const BuildOptions& options, std::size_t count) {
    if (options.max_leaf_size < 1 || options.max_leaf_size > 15) {
        throw Error("leaf size", "must be 1 to 15, not " + std::to_string(options.max_leaf_size));
    }
    if (!(options.traversal_cost >= 0.0 && options.traversal_cost <= 1e6)) {
        throw Error("traversal cost", "must be 0 to 1e6");
    }
    for (const geometry::Segment& ray : options.rays) {
        if (!geometry::is_finite(ray.from) || !geometry::is_finite(ray.to)) {
            throw Error("sample of rays", "must be finite", "end rays where they hit");
        }
    }
    if (count >= std::size_t{1} << 31) {
        throw Error("hierarchy", "cannot hold 2^31 boxes or more", "split the scene");
    }
}

}  // namespace

Tree Tree::build(std::span<const geometry::Aabb> boxes,
                 const BuildOptions& options,
                 Executor& executor) {
    check(options, boxes.size());
    if (boxes.empty()) {
        return {};
    }
    switch (options.builder) {
        case Builder::binned_sah:
            return options.rays.empty() ? build_binned_sah(boxes, options, executor)
                                        : build_ray_distribution(boxes, options, executor);
        case Builder::sweep_sah:
            return build_sweep_sah(boxes, options, executor);
        case Builder::spatial_median:
            return build_spatial_median(boxes, options, executor);
        case Builder::quality:
            return build_quality(boxes, options, executor);
        case Builder::lbvh:
            return build_lbvh(boxes, options, executor);
        case Builder::hybrid:
            return build_hybrid(boxes, options, executor);
        case Builder::fast:
            return build_fast(boxes, options, executor);
    }
    throw Error("builder", "is not known");
}

Tree Tree::from_nodes(std::vector<Node> nodes, std::vector<std::uint32_t> primitives) {
    Tree tree;
    tree.nodes_ = std::move(nodes);
    tree.primitives_ = std::move(primitives);
    return tree;
}

}  // namespace earshot::bvh
