// SPDX-License-Identifier: MIT
#include "earshot/io/directivity_file.h"
#include "earshot/io/internal/acoustics_extras.h"
#include "earshot/io/internal/gltf_scene.h"
#include "earshot/io/internal/scene_folder.h"
#include "earshot/io/internal/scene_parts.h"

#include <algorithm>
#include <set>

namespace earshot::io {
namespace {

using Json = nlohmann::json;
using propagation::Emitter;
using propagation::Scene;

/// The file's materials in its order, so that indices stay. Only those in use are warned about.
void add_materials(const GltfFile& file, const GltfGeometry& geometry, LoadedScene& loaded) {
    Scene& scene = loaded.scene;
    const std::size_t count = file.json.contains("materials") ? file.json["materials"].size() : 0;
    std::vector<bool> is_used(count + 1, false);  // the last: triangles without material
    for (const int material : geometry.material_of_triangle) {
        const std::size_t index = material < 0 ? count : static_cast<std::size_t>(material);
        is_used[index] = true;
        scene.material_of_triangle.push_back(static_cast<std::uint32_t>(index));
    }
    const auto add = [&](ReadMaterial read, bool used) {
        if (used && read.is_default) {
            loaded.default_materials.push_back(static_cast<std::uint32_t>(scene.materials.size()));
        }
        if (used && read.is_by_name) {
            loaded.materials_by_name.push_back(static_cast<std::uint32_t>(scene.materials.size()));
        }
        scene.materials.push_back(std::move(read.material));
    };
    Warnings unused;
    for (std::size_t i = 0; i < count; ++i) {
        const Json& json = file.json["materials"][i];
        const std::string given = json.value("name", std::string());
        const std::string name = given.empty() ? "material " + std::to_string(i) : given;
        add(read_material(json, name, file.name, is_used[i] ? loaded.acoustic_warnings : unused),
            is_used[i]);
    }
    if (is_used[count]) {
        add(material_named("default"), true);
    }
}

/// The audio emitter that KHR_audio_emitter puts on a node; -1: none.
int audio_emitter_of(const GltfFile& file, const Json& node, const std::string& name) {
    const Json::json_pointer pointer("/extensions/KHR_audio_emitter/emitter");
    if (!node.contains(pointer)) {
        return -1;
    }
    const Json& emitter = node[pointer];
    const Json::json_pointer list("/extensions/KHR_audio_emitter/emitters");
    const std::size_t count = file.json.contains(list) ? file.json[list].size() : 0;
    if (!emitter.is_number_unsigned() || emitter.get<std::uint64_t>() >= count) {
        file.fail("node \"" + name + "\"",
                  "its audio emitter " + condensed(emitter.dump()) + " is not below " +
                      std::to_string(count));
    }
    return emitter.get<int>();
}

/// A named pattern, or a table in the scene's folder.
propagation::Directivity directivity_of(const std::string& name,
                                        const SceneFolder& folder,
                                        const std::string& subject) {
    if (std::filesystem::path(name).extension() != ".csv") {
        return directivity_named(name, {}, subject);
    }
    const auto file = folder.find(name, subject);
    if (!file) {
        throw Error(subject,
                    "its directivity file " + condensed(name) + " is missing",
                    "copy it beside the scene");
    }
    return read_directivity(*file);
}

void add_emitters(const GltfFile& file,
                  const GltfNodes& nodes,
                  const SceneFolder& folder,
                  LoadedScene& loaded) {
    for (std::size_t i = 0; i < file.model.nodes.size(); ++i) {
        if (!nodes.in_scene[i]) {
            continue;
        }
        const Json& json = file.json["nodes"][i];
        Emitter emitter;
        emitter.name = node_name(file, i);
        emitter.node = nodes.index_of[i];
        const NodeAcoustics acoustics =
            read_node_acoustics(json, emitter.name, file.name, loaded.acoustic_warnings);
        if (!acoustics.directivity.empty()) {
            emitter.directivity = directivity_of(
                acoustics.directivity, folder, file.name + ": node \"" + emitter.name + "\"");
        }
        const bool has_audio_emitter = audio_emitter_of(file, json, emitter.name) >= 0;
        if (acoustics.role == Role::listener) {
            loaded.scene.listeners.push_back(emitter);
        }
        if (acoustics.role == Role::source || has_audio_emitter) {
            loaded.scene.sources.push_back(std::move(emitter));
        }
    }
}

/// Results are stored by name, so two of a name would overwrite each other.
void refuse_equal_names(const std::vector<Emitter>& emitters,
                        const char* kind,
                        const std::string& file) {
    std::set<std::string> names;
    for (const Emitter& emitter : emitters) {
        if (!names.insert(emitter.name).second) {
            throw Error(file,
                        std::string("two ") + kind + " are named \"" + emitter.name + "\"",
                        "give each node a name of its own");
        }
    }
}

}  // namespace

LoadedScene load_gltf(const std::filesystem::path& path, const SceneOptions& options) {
    const SceneFolder folder(path, options.allow_outside);
    const GltfFile file = read_gltf_file(path, folder);
    LoadedScene loaded;
    loaded.warnings = file.warnings;
    GltfNodes nodes = read_nodes(file);
    read_instances(file, nodes, loaded.warnings);
    read_animation(file, options.animation, nodes, loaded.warnings);
    GltfGeometry geometry = read_geometry(file, nodes, loaded.warnings);
    add_materials(file, geometry, loaded);
    add_emitters(file, nodes, folder, loaded);
    refuse_equal_names(loaded.scene.sources, "sources", file.name);
    refuse_equal_names(loaded.scene.listeners, "listeners", file.name);
    loaded.scene.mesh = geometry::AnimatedMesh(std::move(nodes.nodes),
                                               std::move(geometry.skins),
                                               std::move(geometry.parts),
                                               std::move(geometry.triangles));
    return loaded;
}

}  // namespace earshot::io
