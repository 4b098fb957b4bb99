// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/io/scene_file.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// The option that gives acoustic data to materials by their names.
class MaterialOptions {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// Assigns what SCENE.materials.json says, if it stands beside the scene, then what the command
    /// line says. Throws Error for unknown library names and damaged files.
    void apply(const std::string& scene_file, io::LoadedScene& loaded) const;

private:
    std::vector<std::string> assignments_;
};

}  // namespace earshot::cli
