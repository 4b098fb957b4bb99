// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/io/name_choice.h"
#include "earshot/propagation/scene.h"
#include "earshot/propagation/trajectory.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace earshot::cli {

/// Trajectories by the name of the source or listener.
using Ways = std::map<std::string, propagation::Trajectory>;

/// The option that moves sources and listeners along trajectories from tables.
class WayOptions {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// Reads the tables, in the unit and axes of the scene's file. Throws UsageError for values
    /// that are not of their form, Error for names that the scene does not know or that stand
    /// twice, and for files that cannot be read.
    Ways read(const CLI::App& app,
              const SceneChoice& choice,
              const propagation::Scene& scene) const;

private:
    std::vector<std::string> ways_;
};

/// The index of the chosen emitter of a scene; as io::find_name().
std::size_t find_emitter(const std::string& file,
                         const std::vector<propagation::Emitter>& emitters,
                         const io::NameChoice& choice);

}  // namespace earshot::cli
