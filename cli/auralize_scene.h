// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/format_choice.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/simulation_choice.h"
#include "earshot/cli/way_options.h"
#include "earshot/propagation/moving_sound.h"

#include <cstdint>
#include <string>

namespace earshot::cli {

/// The options of `earshot auralize --scene`, and a scene in which recordings are played while it,
/// sources or the listener move.
class AuralizeScene {
public:
    AuralizeScene();

    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    bool is_chosen() const noexcept { return !file_.empty(); }

    /// The values of --from and --to.
    const std::string& from() const noexcept { return from_; }
    const std::string& to() const noexcept { return to_; }

    /// The options of channels, which --paths takes, too.
    const FormatChoice& format_choice() const noexcept { return format_choice_; }

    /// Reads the scene. Call before play(). Throws Error, and UsageError for options that are
    /// not of their form.
    void load(const CLI::App& app, std::int64_t seed);

    /// What the listener hears of a mono recording played by the source of that name, or, if it is
    /// empty, by that of --from, or the only one. Throws Error if there is no such source.
    propagation::MovingSound play(const std::string& source,
                                  const std::string& recording_name,
                                  const audio::Signal& recording,
                                  Executor& executor,
                                  Progress& progress) const;

    /// What is odd about the scene.
    const Warnings& warnings() const noexcept { return warnings_; }

private:
    std::string file_, from_, to_;
    WayOptions ways_;
    SceneChoice scene_choice_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    SimulationChoice simulation_choice_;
    FormatChoice format_choice_;
    std::int64_t diffraction_ = 0;
    double step_ = 0.05, late_step_ = 0.5, start_ = 0.0;

    // After load().
    propagation::Scene scene_;
    propagation::Options simulation_;
    propagation::ResponseFormat format_;
    Ways trajectories_;
    Warnings warnings_;
};

}  // namespace earshot::cli
