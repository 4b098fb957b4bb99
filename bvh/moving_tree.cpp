// SPDX-License-Identifier: MIT
#include "earshot/bvh/moving_tree.h"

#include "earshot/bvh/aging.h"
#include "earshot/bvh/optimise.h"

#include <algorithm>
#include <cmath>

namespace earshot::bvh {
namespace {

// Prices per triangle, in steps of a random ray: measured on meshes of 0.07 to 1.4 million
// triangles (docs/algorithms/bvh-deformation.md), where a step takes about 20 ns. A build's grows
// with the depth.
constexpr double kRepairPrice = 10.0;
constexpr double kBuildPricePerLevel = 1.0;

// Two batches: what a frame of motion spoils is mostly found among the largest boxes.
constexpr OptimiseOptions kRepair = {.passes = 2, .share = 0.005};

// Less is not worth the time, and is waited for twice as long the next time.
constexpr double kLeastGain = 0.03;
constexpr double kMostPatience = 64.0;

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

MovingTree::MovingTree(const geometry::MeshView& mesh,
                       const UpdateOptions& options,
                       Executor& executor)
    : options_(options) {
    const auto count = static_cast<double>(mesh.triangles.size());
    repair_.price = kRepairPrice * count;
    rebuild_.price = kBuildPricePerLevel * count * std::max(1.0, std::log2(count + 1.0));
    build(mesh, executor);
    repair_.fresh = rebuild_.fresh = expected_steps(wide_, executor);
}

void MovingTree::build(const geometry::MeshView& mesh, Executor& executor) {
    tree_ = Tree::build(triangle_boxes(mesh, executor), options_.build, executor);
    wide_ = WideTree::build(tree_, mesh, executor);
    ++version_;
}

void MovingTree::repair(const geometry::MeshView& mesh, Executor& executor) {
    tree_.refit(triangle_boxes(mesh, executor), executor);
    if (optimise(tree_, kRepair, executor).moves > 0) {
        wide_ = WideTree::build(tree_, mesh, executor);
        ++version_;
    }
}

bool MovingTree::is_due(const Remedy& remedy) noexcept {
    return remedy.owed > 0.0 && remedy.owed >= remedy.patience * remedy.price;
}

void MovingTree::settle(Remedy& remedy, const UpdateReport& report) noexcept {
    const bool has_helped = report.steps < (1.0 - kLeastGain) * report.refitted_steps;
    remedy.patience = has_helped ? 1.0 : std::min(2.0 * remedy.patience, kMostPatience);
    remedy.owed = 0.0;
    remedy.fresh = report.steps;
}

UpdateReport MovingTree::update(const geometry::MeshView& mesh, Executor& executor) {
    wide_.refit(mesh, executor);
    UpdateReport report;
    report.refitted_steps = report.steps = expected_steps(wide_, executor);
    for (Remedy* remedy : {&repair_, &rebuild_}) {
        remedy->owed += std::max(0.0, report.steps - remedy->fresh) * options_.rays_per_update;
    }
    if (is_due(rebuild_)) {
        build(mesh, executor);
        report.action = UpdateAction::rebuild;
        report.steps = expected_steps(wide_, executor);
        settle(rebuild_, report);
        // What is fresh needs no repair.
        repair_.owed = 0.0;
        repair_.fresh = report.steps;
    } else if (is_due(repair_)) {
        repair(mesh, executor);
        report.action = UpdateAction::repair;
        report.steps = expected_steps(wide_, executor);
        settle(repair_, report);
    }
    return report;
}

}  // namespace earshot::bvh
