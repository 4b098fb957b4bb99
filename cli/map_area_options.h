// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/propagation/metric_map.h"

#include <optional>
#include <string>

namespace earshot::cli {

/// The options that say where a map is made.
class MapAreaOptions {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// What can be told without the scene. Throws UsageError unless there is exactly one area, of
    /// its form.
    void check(const CLI::App& app) const;

    /// Throws Error if the scene has no such material or the table of points is damaged.
    propagation::MapArea area(const CLI::App& app,
                              const SceneChoice& choice,
                              const propagation::Scene& scene) const;

    double step() const noexcept { return step_; }
    double coarse_step() const noexcept;
    double clearance() const noexcept { return clearance_; }

private:
    propagation::MapRectangle rectangle(const CLI::App& app, const SceneChoice& choice) const;

    std::string rectangle_, material_, points_file_;
    std::optional<double> height_;  // in the file's unit
    double step_ = 0.25, clearance_ = 0.1;
    std::optional<double> coarse_step_;
};

}  // namespace earshot::cli
