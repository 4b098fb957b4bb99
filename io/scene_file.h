// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/scene.h"

#include <filesystem>
#include <string>

namespace earshot::io {

struct LoadedScene {
    propagation::Scene scene;
    Warnings warnings;  ///< each names what was odd: a material without acoustic data, ...
};

struct SceneOptions {
    /// Name or index of the glTF animation that moves the scene; empty: the first one.
    std::string animation;
};

/// Reads .gltf, .glb, .obj, .ply, .stl or .off (by suffix, any case); docs/files.md says what is
/// understood. Throws Error naming the file and the fault; nothing is half read.
LoadedScene load_scene(const std::filesystem::path& file, const SceneOptions& options = {});

/// Coordinates beyond this (metres) are taken for a damaged file: double precision still resolves
/// a tenth of a millimetre there, and squares of distances stay far from overflow.
inline constexpr double kMaxCoordinate = 1e12;

}  // namespace earshot::io
