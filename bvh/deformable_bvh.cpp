// SPDX-License-Identifier: MIT
#include "earshot/bvh/deformable_bvh.h"

#include "earshot/bvh/grouped_tree.h"
#include "earshot/bvh/internal/slot_nodes.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace earshot::bvh {
namespace {

constexpr ReinsertionOptions kRepair = {.max_iterations = 2, .batch_size_ratio = 0.02};

// A partial refit costs some 1.6 times as much per triangle as a full one, and takes one thread.
constexpr std::size_t kPartialRefitShare = 4;

}  // namespace

/// Costs per primitive, in node visits of queries: measured on meshes of 3,000 to 1.4 million
/// triangles (docs/algorithms/bvh-deformation.md). A build's cost grows with the depth.
struct DeformableBvh::Prices {
    double repair, build_per_level, restore, look_up;

    /// A visit of a random ray takes about 20 ns.
    static constexpr Prices of_mesh() { return {8.5, 0.75, 5.0, 2.0}; }
    /// A visit of a binary node takes about 10 ns.
    static constexpr Prices of_boxes() { return {5.0, 1.0, 0.0, 1.5}; }
};

DeformableBvh::DeformableBvh(const geometry::MeshView& mesh,
                             const UpdateOptions& options,
                             Executor& executor)
    : options_(options), mesh_(mesh) {
    adopt(topology_of(build(triangle_boxes(mesh, executor), executor), &mesh, executor));
    options_.build.rays = {};  // read during the first build only
    set_policy(Prices::of_mesh(), mesh.triangles.size());
}

DeformableBvh::DeformableBvh(std::span<const geometry::Aabb> boxes,
                             const UpdateOptions& options,
                             Executor& executor)
    : options_(options) {
    adopt(topology_of(build(boxes, executor), nullptr, executor));
    options_.build.rays = {};
    set_policy(Prices::of_boxes(), boxes.size());
}

void DeformableBvh::set_policy(const Prices& prices, std::size_t primitives) {
    const auto count = static_cast<double>(primitives);
    const double build = prices.build_per_level * std::max(1.0, std::log2(count + 1.0));
    policy_ = UpdatePolicy({.repair = (prices.repair + options_.topology_cost) * count,
                            .rebuild = (build + options_.topology_cost) * count,
                            .restore = (prices.restore + options_.topology_cost) * count,
                            .look_up = prices.look_up * count},
                           sah_cost_);
}

void DeformableBvh::expect_node_visits(double visits) noexcept {
    expect_queries(sah_cost_ > 0.0 ? visits / sah_cost_ : 0.0);
}

Tree DeformableBvh::build(std::span<const geometry::Aabb> boxes, Executor& executor) const {
    return options_.group_ends.empty()
               ? Tree::build(boxes, options_.build, executor)
               : build_grouped(boxes, options_.group_ends, options_.build, executor);
}

DeformableBvh::Topology DeformableBvh::topology_of(Tree tree,
                                                   const geometry::MeshView* mesh,
                                                   Executor& executor) const {
    Topology result{.tree = std::move(tree), .wide = {}};
    if (mesh == nullptr) {
        result.sah_cost = bvh::sah_cost(result.tree);
    } else {
        result.wide = WideTree::build(result.tree, *mesh, executor);
        result.sah_cost = bvh::sah_cost(result.wide, executor);
    }
    return result;
}

/// This tree with subtrees reinserted, if that is worthwhile.
std::optional<Tree> DeformableBvh::repaired(std::span<const geometry::Aabb> boxes,
                                            Executor& executor) {
    Tree tree = tree_;
    tree.refit(boxes, executor);
    const std::vector<std::uint32_t> groups = groups_of_nodes(tree, options_.group_ends);
    ReinsertionOptions options = kRepair;
    options.group_of_node = groups;
    const ReinsertionReport report = optimise_by_reinsertion(tree, options, executor);
    // A wide tree gains about as much as the binary tree.
    const double factor = report.sah_cost_after / report.sah_cost_before;
    if (!policy_.is_repair_worthwhile(sah_cost_, factor * sah_cost_)) {
        return std::nullopt;
    }
    return tree;
}

void DeformableBvh::adopt(Topology&& topology) {
    tree_ = std::move(topology.tree);
    wide_ = std::move(topology.wide);
    partial_refit_.reset();
    sah_cost_ = topology.sah_cost;
    ++version_;
}

/// What the kept topology would cost where the boxes are now.
double DeformableBvh::look_up_kept(const geometry::MeshView* mesh,
                                   std::span<const geometry::Aabb> boxes,
                                   Executor& executor) const {
    Tree tree = kept_;
    tree.refit(boxes, executor);
    return mesh == nullptr ? bvh::sah_cost(tree) : bvh::sah_cost(tree, kept_slots_);
}

/// The first topology is kept when another takes its place; others are dropped.
void DeformableBvh::replace(Topology&& topology, const geometry::MeshView* mesh) {
    if (is_first_topology_) {
        keep_current(mesh);
        is_first_topology_ = false;
    }
    adopt(std::move(topology));
}

/// The kept topology takes over; that which was in use is kept.
void DeformableBvh::restore_kept(const geometry::MeshView* mesh,
                                 std::span<const geometry::Aabb> boxes,
                                 Executor& executor) {
    Topology restored{.tree = std::move(kept_), .wide = {}};
    keep_current(mesh);
    if (mesh == nullptr) {
        restored.tree.refit(boxes, executor);
        restored.sah_cost = bvh::sah_cost(restored.tree);
    } else {
        // The tree still has the boxes that its wide tree was collapsed for, so that it becomes
        // the same wide tree again.
        restored.wide = WideTree::build(restored.tree, *mesh, executor);
        restored.wide.refit(*mesh, executor);
        restored.sah_cost = bvh::sah_cost(restored.wide, executor);
    }
    is_first_topology_ = !is_first_topology_;
    adopt(std::move(restored));
}

void DeformableBvh::keep_current(const geometry::MeshView* mesh) {
    kept_slots_ = mesh == nullptr ? std::vector<std::uint32_t>{} : slot_nodes(tree_, wide_);
    kept_ = std::move(tree_);
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
    sah_cost_ = bvh::sah_cost(wide_, executor);
    return take_action(&mesh, {}, executor);
}

UpdateReport DeformableBvh::update(std::span<const geometry::Aabb> boxes, Executor& executor) {
    tree_.refit(boxes, executor);
    sah_cost_ = bvh::sah_cost(tree_);
    return take_action(nullptr, boxes, executor);
}

/// Takes the action that is due after a refit.
UpdateReport DeformableBvh::take_action(const geometry::MeshView* mesh,
                                        std::span<const geometry::Aabb> boxes,
                                        Executor& executor) {
    UpdateReport report{.action = policy_.choose(sah_cost_, options_.queries_per_update),
                        .sah_cost_after_refit = sah_cost_};
    const bool looks_up = !kept_.nodes().empty() && policy_.is_look_up_due(report.action);
    if (report.action != UpdateAction::refit || looks_up) {
        std::vector<geometry::Aabb> triangles;
        if (mesh != nullptr) {
            triangles = triangle_boxes(*mesh, executor);
            boxes = triangles;
        }
        // What the kept topology would cost, if that is known.
        double kept_cost = std::numeric_limits<double>::infinity();
        if (looks_up) {
            kept_cost = look_up_kept(mesh, boxes, executor);
            report.is_restored = policy_.should_restore(report.action, sah_cost_, kept_cost);
        }
        if (report.is_restored) {
            restore_kept(mesh, boxes, executor);
            report.action = UpdateAction::repair;
        } else if (report.action != UpdateAction::refit) {
            change_topology(report, kept_cost, mesh, boxes, executor);
        }
    }
    report.sah_cost = sah_cost_;
    statistics_.count(report.action);
    return report;
}

/// Repairs or rebuilds, unless the tree or the kept topology is better than the new one.
void DeformableBvh::change_topology(UpdateReport& report,
                                    double kept_cost,
                                    const geometry::MeshView* mesh,
                                    std::span<const geometry::Aabb> boxes,
                                    Executor& executor) {
    std::optional<Tree> tree;
    if (report.action == UpdateAction::repair) {
        tree = repaired(boxes, executor);
    }
    if (!tree) {
        report.action = UpdateAction::rebuild;
        tree = build(boxes, executor);
    }
    Topology changed = topology_of(std::move(*tree), mesh, executor);
    if (changed.sah_cost < std::min(sah_cost_, kept_cost)) {
        replace(std::move(changed), mesh);
    } else if (kept_cost < sah_cost_) {
        restore_kept(mesh, boxes, executor);
        report.is_restored = true;
    }
    report.sah_cost = sah_cost_;
    policy_.record_outcome(report);
}

}  // namespace earshot::bvh
