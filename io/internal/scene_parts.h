// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/scene_file.h"

#include <filesystem>
#include <string>

namespace earshot::io {

/// A scene of a .gltf or .glb file. Throws Error.
LoadedScene load_gltf(const std::filesystem::path& file, const SceneOptions& options);

/// Which plain mesh format a file is in.
enum class MeshFormat { obj, ply, stl, off };

/// A scene of a file that knows polygons and at most names of materials; `frame` says how its
/// coordinates are meant. Throws Error.
LoadedScene load_mesh_file(const std::filesystem::path& file,
                           MeshFormat format,
                           const FileFrame& frame);

}  // namespace earshot::io
