// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/quality.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace earshot::cli {

/// The hierarchy at one instant of the animation.
struct HierarchyFrame {
    double time = 0.0;              ///< seconds, of the animation
    double sah_cost = 0.0;          ///< of the tree built at the first instant and refitted since
    double rebuilt_sah_cost = 0.0;  ///< of a tree built at this instant
    double refit_seconds = 0.0;
    double build_seconds = 0.0;
    // Expected steps of a random ray over the wide layout, kept in three ways
    // (bvh::sah_cost).
    double refit_steps = 0.0;    ///< built at the first instant and refitted since
    double rebuild_steps = 0.0;  ///< built at this instant
    double update_steps = 0.0;   ///< kept by bvh::DeformableBvh
    bvh::UpdateAction action{};  ///< what it did
    double update_seconds = 0.0;
};

struct HierarchyOptions {
    bvh::BuildOptions build{};
    double rays_per_frame = 1e6;  ///< see bvh::UpdateOptions
};

/// What `earshot bvh` tells about the hierarchy of a scene. Times include the boxes of the
/// triangles: they run from moved vertices to a tree that can be asked.
struct HierarchyReport {
    std::string scene;
    std::size_t triangles = 0;
    bvh::Quality quality;                  ///< as built at the first instant
    std::size_t wide_bytes = 0;            ///< of the layout for rays made from it
    std::size_t quantised_bytes = 0;       ///< and with quantised leaves
    double build_seconds = 0.0;            ///< median over the repetitions
    double refit_seconds = 0.0;            ///< median over the repetitions
    std::vector<HierarchyFrame> frames{};  ///< one per instant; empty where one was asked for
};

/// Builds the tree at the first instant, measures, and follows the animation
/// through the others. Precondition: at least one instant.
HierarchyReport measure_hierarchy(const propagation::Scene& scene,
                                  std::span<const double> times,
                                  const HierarchyOptions& options,
                                  Executor& executor);

std::string hierarchy_text(const HierarchyReport& report);
std::string hierarchy_json(const HierarchyReport& report);

/// A picture of steps per ray over the frames, for a tree that is refitted only, rebuilt always,
/// and kept by bvh::DeformableBvh: an SVG file. Precondition: there are frames.
std::string hierarchy_plot(const HierarchyReport& report);

}  // namespace earshot::cli
