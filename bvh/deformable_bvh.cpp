// SPDX-License-Identifier: MIT
#include "earshot/bvh/deformable_bvh.h"

#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"

#include <algorithm>
#include <cmath>

namespace earshot::bvh {
namespace {

// Costs per triangle, in node visits of a random ray: measured on meshes of 0.07 to 1.4 million
// triangles (docs/algorithms/bvh-deformation.md), where a visit takes about 20 ns. A build's cost
// grows with the depth.
constexpr double kRepairCostPerTriangle = 10.0;
constexpr double kBuildCostPerTriangleLevel = 1.0;

// Two batches: what a frame of motion degrades is mostly found among the largest boxes.
constexpr ReinsertionOptions kRepairOptions = {.max_iterations = 2, .batch_size_ratio = 0.005};

// An action that lowers the SAH cost by less has not paid, and backs off.
constexpr double kMinGain = 0.03;
constexpr double kMaxBackoff = 64.0;

}  // namespace

std::string_view name_of(UpdateAction action) noexcept {
    switch (action) {
        case UpdateAction::refit:
            return "refit";
        case UpdateAction::repair:
            return "repair";
        case UpdateAction::rebuild:
            break;
    }
    return "rebuild";
}

bool DeformableBvh::ActionAccount::is_due() const noexcept {
    return accumulated_excess > 0.0 && accumulated_excess >= backoff * action_cost;
}

void DeformableBvh::ActionAccount::accumulate(double sah_cost, double rays) noexcept {
    accumulated_excess += std::max(0.0, sah_cost - baseline_sah_cost) * rays;
}

void DeformableBvh::ActionAccount::record_outcome(const UpdateReport& report) noexcept {
    const bool has_paid = report.sah_cost < (1.0 - kMinGain) * report.sah_cost_after_refit;
    backoff = has_paid ? 1.0 : std::min(2.0 * backoff, kMaxBackoff);
    reset(report.sah_cost);
}

void DeformableBvh::ActionAccount::reset(double sah_cost) noexcept {
    accumulated_excess = 0.0;
    baseline_sah_cost = sah_cost;
}

DeformableBvh::DeformableBvh(const geometry::MeshView& mesh,
                             const UpdateOptions& options,
                             Executor& executor)
    : options_(options) {
    const auto count = static_cast<double>(mesh.triangles.size());
    repair_.action_cost = kRepairCostPerTriangle * count;
    rebuild_.action_cost =
        kBuildCostPerTriangleLevel * count * std::max(1.0, std::log2(count + 1.0));
    build(mesh, executor);
    repair_.baseline_sah_cost = rebuild_.baseline_sah_cost = sah_cost(wide_, executor);
}

void DeformableBvh::build(const geometry::MeshView& mesh, Executor& executor) {
    tree_ = Tree::build(triangle_boxes(mesh, executor), options_.build, executor);
    wide_ = WideTree::build(tree_, mesh, executor);
    ++version_;
}

void DeformableBvh::repair(const geometry::MeshView& mesh, Executor& executor) {
    tree_.refit(triangle_boxes(mesh, executor), executor);
    if (optimise_by_reinsertion(tree_, kRepairOptions, executor).reinsertions > 0) {
        wide_ = WideTree::build(tree_, mesh, executor);
        ++version_;
    }
}

UpdateReport DeformableBvh::update(const geometry::MeshView& mesh, Executor& executor) {
    // Refit always; its excess cost is charged to both accounts.
    wide_.refit(mesh, executor);
    UpdateReport report;
    report.sah_cost_after_refit = report.sah_cost = sah_cost(wide_, executor);
    for (ActionAccount* account : {&repair_, &rebuild_}) {
        account->accumulate(report.sah_cost, options_.rays_per_update);
    }
    if (rebuild_.is_due()) {
        build(mesh, executor);
        report.action = UpdateAction::rebuild;
        report.sah_cost = sah_cost(wide_, executor);
        rebuild_.record_outcome(report);
        // A new tree needs no repair.
        repair_.reset(report.sah_cost);
    } else if (repair_.is_due()) {
        repair(mesh, executor);
        report.action = UpdateAction::repair;
        report.sah_cost = sah_cost(wide_, executor);
        repair_.record_outcome(report);
    }
    return report;
}

}  // namespace earshot::bvh
