// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/io/file_frame.h"
#include "earshot/propagation/scene.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace earshot::io {

struct LoadedScene {
    propagation::Scene scene;
    Warnings warnings;           ///< each names what was odd
    Warnings acoustic_warnings;  ///< the same of acoustic data; of no matter where none is used
    /// Indices into the scene's materials, ascending: those of a triangle that have no acoustic
    /// data and take the default: absorption 0.1 and scattering 0.1.
    std::vector<std::uint32_t> default_materials;
    /// The same of those without data that take those of the library's material of their name: a
    /// guess.
    std::vector<std::uint32_t> materials_by_name;
};

/// What to tell where acoustic data is used: acoustic_warnings and, if materials take the default,
/// one warning that names them.
Warnings warnings_of_acoustics(const LoadedScene& loaded);

struct SceneOptions {
    /// Name or index of the glTF animation that moves the scene; empty: the first one.
    std::string animation{};
    /// How the coordinates of a mesh file are meant; the scene is in metres, +Y up. Of a glTF file
    /// only the default is right, anything else an Error.
    FileFrame frame{};
    /// Whether a glTF scene may name files outside of the folder of its real path.
    bool allow_outside = false;
};

/// Reads .gltf, .glb, .obj, .ply, .stl or .off (by suffix, any case); docs/files.md says what is
/// understood. Throws Error naming the file and the fault; nothing is half read.
LoadedScene load_scene(const std::filesystem::path& file, const SceneOptions& options = {});

/// Whether a file is glTF by its suffix.
bool is_gltf(const std::filesystem::path& file);

/// Coordinates beyond this (metres) are taken for a damaged file: double precision still resolves
/// a tenth of a millimetre there, and squares of distances stay far from overflow.
inline constexpr double kMaxCoordinate = 1e12;

}  // namespace earshot::io
