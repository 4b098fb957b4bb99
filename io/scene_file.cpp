// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include "earshot/io/internal/scene_parts.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace earshot::io {
namespace {

namespace fs = std::filesystem;

std::string lower_case_suffix(const fs::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](char c) {
        return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    });
    return suffix;
}

void check_file(const fs::path& file) {
    std::error_code ignored;
    const fs::file_status status = fs::status(file, ignored);
    if (!fs::exists(status)) {
        throw Error(file.string(), "no such file", "check the name and the directory");
    }
    if (fs::is_directory(status)) {
        throw Error(file.string(), "is a directory, not a scene", "name a file in it");
    }
    if (fs::is_regular_file(status) && fs::file_size(file, ignored) == 0) {
        throw Error(file.string(), "is empty", "copy or export the file again");
    }
}

LoadedScene load_by_suffix(const fs::path& file, const SceneOptions& options) {
    const std::string suffix = lower_case_suffix(file);
    if (is_gltf(file)) {
        if (!options.frame.is_default()) {
            throw Error(file.string(),
                        "is glTF, which is in metres with +Y up",
                        "leave out --units and --up");
        }
        return load_gltf(file, options);
    }
    if (suffix == ".obj") {
        return load_mesh_file(file, MeshFormat::obj, options.frame);
    }
    if (suffix == ".ply") {
        return load_mesh_file(file, MeshFormat::ply, options.frame);
    }
    if (suffix == ".stl") {
        return load_mesh_file(file, MeshFormat::stl, options.frame);
    }
    if (suffix == ".off") {
        return load_mesh_file(file, MeshFormat::off, options.frame);
    }
    throw Error(file.string(),
                suffix.empty() ? "has no suffix, which selects the format"
                               : "has an unknown suffix: " + suffix,
                "use .gltf, .glb, .obj, .ply, .stl or .off");
}

void check_place(const geometry::Vec3& p, std::string_view what, const std::string& file) {
    const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const bool is_near = largest <= kMaxCoordinate && p == p;  // false for what is no number
    if (!is_near) {
        throw Error(file,
                    std::string(what) + " lies beyond 1e12 m once its node has moved it",
                    "check scales and units of the export");
    }
}

/// At time 0.
void check_extent(const propagation::Scene& scene, const std::string& file) {
    if (scene.mesh.triangles().empty()) {
        throw Error(file, "holds no triangles", "export at least one surface");
    }
    for (const geometry::Vec3& position : scene.mesh.positions_at(0.0)) {
        check_place(position, "a vertex", file);
    }
    for (const propagation::Emitter& source : scene.sources) {
        check_place(scene.position_at(source, 0.0), "source \"" + source.name + "\"", file);
    }
    for (const propagation::Emitter& listener : scene.listeners) {
        check_place(scene.position_at(listener, 0.0), "listener \"" + listener.name + "\"", file);
    }
}

}  // namespace

bool is_gltf(const fs::path& file) {
    const std::string suffix = lower_case_suffix(file);
    return suffix == ".gltf" || suffix == ".glb";
}

Warnings warnings_of_acoustics(const LoadedScene& loaded) {
    constexpr std::size_t kMaxNames = 12;
    Warnings warnings = loaded.acoustic_warnings;
    const std::vector<std::uint32_t>& indices = loaded.default_materials;
    if (indices.empty()) {
        return warnings;
    }
    std::string names;
    for (std::size_t i = 0; i < std::min(kMaxNames, indices.size()); ++i) {
        names += (i == 0 ? "\"" : ", \"") + loaded.scene.materials[indices[i]].name + "\"";
    }
    if (indices.size() > kMaxNames) {
        names += " and " + std::to_string(indices.size() - kMaxNames) + " more";
    }
    warnings.push_back(
        {loaded.scene.name,
         (indices.size() == 1
              ? "material " + names + " has no acoustic data and takes"
              : std::to_string(indices.size()) + " materials have no acoustic " + "data and take") +
             " absorption 0.1 and scattering 0.1" + (indices.size() == 1 ? "" : ": " + names)});
    return warnings;
}

LoadedScene load_scene(const fs::path& file, const SceneOptions& options) {
    check_file(file);
    try {
        LoadedScene loaded = load_by_suffix(file, options);
        check_extent(loaded.scene, file.string());
        loaded.scene.name = file.filename().string();
        return loaded;
    } catch (const Error& error) {
        if (error.subject() == file.string()) {
            throw;
        }
        throw Error(file.string(), error.subject() + ": " + error.what(), error.remedy());
    } catch (const std::bad_alloc&) {
        throw Error(file.string(), "needs more memory than is available", "split the scene");
    } catch (const std::length_error&) {
        throw Error(file.string(), "needs more memory than is available", "split the scene");
    }
}

}  // namespace earshot::io
