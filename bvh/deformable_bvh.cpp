// SPDX-License-Identifier: MIT
#include "earshot/bvh/deformable_bvh.h"

#include "earshot/bvh/grouped_tree.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::bvh {
namespace {

// Costs per primitive, in node visits of a random ray: measured on meshes of 0.07 to 1.4 million
// triangles (docs/algorithms/bvh-deformation.md), where a visit takes about 20 ns. A build's cost
// grows with the depth.
constexpr double kRepairCostPerPrimitive = 10.0;
constexpr double kBuildCostPerPrimitiveLevel = 1.0;

// Two batches: what a frame of motion degrades is mostly found among the largest boxes.
constexpr int kRepairBatches = 2;
constexpr double kRepairBatchRatio = 0.005;

// A partial refit costs some 1.6 times as much per triangle as a full one, and takes one thread.
constexpr std::size_t kPartialRefitShare = 4;

}  // namespace

DeformableBvh::DeformableBvh(const geometry::MeshView& mesh,
                             const UpdateOptions& options,
                             Executor& executor)
    : options_(options), mesh_(mesh) {
    tree_ = build(triangle_boxes(mesh, executor), executor);
    options_.build.rays = {};  // read during the first build only
    wide_ = WideTree::build(tree_, mesh, executor);
    set_policy(mesh.triangles.size(), sah_cost(wide_, executor));
}

DeformableBvh::DeformableBvh(std::span<const geometry::Aabb> boxes,
                             const UpdateOptions& options,
                             Executor& executor)
    : options_(options) {
    tree_ = build(boxes, executor);
    options_.build.rays = {};
    set_policy(boxes.size(), bvh::sah_cost(tree_));
}

void DeformableBvh::set_policy(std::size_t primitives, double sah_cost) {
    const auto count = static_cast<double>(primitives);
    const double build = kBuildCostPerPrimitiveLevel * std::max(1.0, std::log2(count + 1.0));
    policy_ = UpdatePolicy({.repair = (kRepairCostPerPrimitive + options_.topology_cost) * count,
                            .rebuild = (build + options_.topology_cost) * count},
                           sah_cost);
    sah_cost_ = sah_cost;
}

void DeformableBvh::expect_node_visits(double visits) noexcept {
    expect_queries(sah_cost_ > 0.0 ? visits / sah_cost_ : 0.0);
}

Tree DeformableBvh::build(std::span<const geometry::Aabb> boxes, Executor& executor) const {
    return options_.group_ends.empty()
               ? Tree::build(boxes, options_.build, executor)
               : build_grouped(boxes, options_.group_ends, options_.build, executor);
}

/// A new tree, or this one with subtrees reinserted.
Tree DeformableBvh::changed_tree(UpdateAction action,
                                 std::span<const geometry::Aabb> boxes,
                                 Executor& executor) {
    if (action == UpdateAction::rebuild) {
        return build(boxes, executor);
    }
    Tree tree = tree_;
    tree.refit(boxes, executor);
    const std::vector<std::uint32_t> groups = groups_of_nodes(tree, options_.group_ends);
    optimise_by_reinsertion(tree,
                            {.max_iterations = kRepairBatches,
                             .batch_size_ratio = kRepairBatchRatio,
                             .group_of_node = groups},
                            executor);
    return tree;
}

/// Takes the action that is due; act(action) returns the SAH cost after it.
template <typename Act>
UpdateReport DeformableBvh::choose(double sah_cost_after_refit, Act&& act) {
    UpdateReport report{.action = policy_.choose(sah_cost_after_refit, options_.queries_per_update),
                        .sah_cost_after_refit = sah_cost_after_refit,
                        .sah_cost = sah_cost_after_refit};
    if (report.action != UpdateAction::refit) {
        report.sah_cost = act(report.action);
        policy_.record_outcome(report);
    }
    sah_cost_ = report.sah_cost;
    statistics_.count(report.action);
    return report;
}

void DeformableBvh::refit_wide(const geometry::MeshView& mesh,
                               std::span<const TriangleRange> moved,
                               Executor& executor) {
    std::size_t count = 0;
    for (const TriangleRange& range : moved) {
        count += range.end - range.begin;
    }
    if (kPartialRefitShare * count > mesh.triangles.size()) {
        wide_.refit(mesh, executor);
        return;
    }
    if (!partial_refit_) {
        partial_refit_.emplace(wide_);
    }
    partial_refit_->refit(wide_, mesh, moved);
}

UpdateReport DeformableBvh::update(const geometry::MeshView& mesh, Executor& executor) {
    const TriangleRange all{0, static_cast<std::uint32_t>(mesh.triangles.size())};
    return update(mesh, std::span(&all, 1), executor);
}

UpdateReport DeformableBvh::update(const geometry::MeshView& mesh,
                                   std::span<const TriangleRange> moved,
                                   Executor& executor) {
    mesh_ = mesh;
    refit_wide(mesh, moved, executor);
    const double refitted = bvh::sah_cost(wide_, executor);
    return choose(refitted, [&](UpdateAction action) {
        Tree tree = changed_tree(action, triangle_boxes(mesh, executor), executor);
        WideTree wide = WideTree::build(tree, mesh, executor);
        const double changed = bvh::sah_cost(wide, executor);
        if (!(changed < refitted)) {
            return refitted;
        }
        tree_ = std::move(tree);
        wide_ = std::move(wide);
        partial_refit_.reset();
        ++version_;
        return changed;
    });
}

UpdateReport DeformableBvh::update(std::span<const geometry::Aabb> boxes, Executor& executor) {
    tree_.refit(boxes, executor);
    const double refitted = bvh::sah_cost(tree_);
    return choose(refitted, [&](UpdateAction action) {
        Tree tree = changed_tree(action, boxes, executor);
        const double changed = bvh::sah_cost(tree);
        if (!(changed < refitted)) {
            return refitted;
        }
        tree_ = std::move(tree);
        ++version_;
        return changed;
    });
}

}  // namespace earshot::bvh
