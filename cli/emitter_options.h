// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/scene.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// The options that add sources and listeners to a scene, turn them and say how sources radiate.
class EmitterOptions {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// Changes the scene that was read from `scene_file`. Throws UsageError for values that are not
    /// of their form, Error for names that the scene does not know or if no source or listener is
    /// there.
    void apply(const CLI::App& app, const std::string& scene_file, propagation::Scene& scene) const;

private:
    std::vector<std::string> sources_, listeners_, directivities_, aims_, looks_;
};

}  // namespace earshot::cli
