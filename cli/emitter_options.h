// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/propagation/scene.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// The options that add sources and listeners to a scene, turn them and say how sources radiate.
class EmitterOptions {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);
    /// The same of sources alone, for commands that have places of their own for listeners.
    void add_sources_to(CLI::App& app);

    /// Changes the scene that was read from the file of `choice`, in whose unit and axes the points
    /// are. Throws UsageError for values that are not of their form, Error for names that stand
    /// twice or that the scene does not know, or, with `require_emitters`, if no source or listener
    /// is there; listeners count only where there are options of them.
    void apply(const CLI::App& app,
               const SceneChoice& choice,
               propagation::Scene& scene,
               bool require_emitters = true) const;

private:
    void add_directions_to(CLI::App& app);

    std::vector<std::string> sources_, listeners_, directivities_, aims_, looks_;
    std::string listeners_file_;
    bool has_listeners_ = false;
};

}  // namespace earshot::cli
