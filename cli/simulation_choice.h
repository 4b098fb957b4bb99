// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/simulator.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace earshot::cli {

/// The options of paths, rays and air.
class SimulationChoice {
public:
    struct Defaults {
        int order = 4;
        double rays_error_percent = 2.0;
        std::size_t max_auto_rays = 1000000;
    };

    SimulationChoice() : SimulationChoice(Defaults{}) {}
    explicit SimulationChoice(const Defaults& defaults);

    /// All options. What adds options must outlive the parsing of the command line.
    void add_to(CLI::App& app);
    void add_paths_to(CLI::App& app);  ///< --order, --transmission
    void add_rays_to(CLI::App& app);   ///< --rays, --rays-error
    void add_sound_to(CLI::App& app);  ///< --bands, and those of the air

    /// Throws UsageError if --rays is not of its form.
    propagation::Options options(const CLI::App& app, std::int64_t seed) const;

private:
    std::int64_t order_;
    std::string rays_ = "auto";
    double rays_error_percent_;
    std::size_t max_auto_rays_;
    bool transmission_ = false;
    std::string bands_ = "octave";
    propagation::Air air_;
    bool no_air_absorption_ = false;
};

}  // namespace earshot::cli
