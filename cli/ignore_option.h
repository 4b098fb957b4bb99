// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/exclusion_mask.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// The option --ignore: materials that queries of visibility treat as absent.
class IgnoreOption {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// Excludes the triangles of these materials. Throws Error, with the nearest name, if the scene
    /// has no material of a name.
    visibility::ExclusionMask mask_for(const propagation::Scene& scene) const;

private:
    std::vector<std::string> names_;
};

}  // namespace earshot::cli
