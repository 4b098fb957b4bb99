// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/gltf_file.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

/// Extensions that earshot reads.
constexpr std::array<std::string_view, 5> kRead{kDracoExtension,
                                                kMeshoptExtension,
                                                kInstancingExtension,
                                                "KHR_mesh_quantization",
                                                "KHR_audio_emitter"};

/// Beginnings of the names of extensions that leave the geometry as it is: appearance, annotation,
/// behaviour.
constexpr std::array<std::string_view, 25> kNoGeometry{"KHR_materials_",
                                                       "KHR_texture_",
                                                       "EXT_texture_",
                                                       "MSFT_texture_",
                                                       "KHR_lights_",
                                                       "EXT_lights_",
                                                       "KHR_xmp",
                                                       "KHR_audio",
                                                       "KHR_technique",
                                                       "KHR_interactivity",
                                                       "KHR_physics_",
                                                       "KHR_implicit_shapes",
                                                       "ADOBE_materials_",
                                                       "AGI_stk_metadata",
                                                       "AGI_articulations",
                                                       "MSFT_packing_",
                                                       "EXT_structural_metadata",
                                                       "EXT_mesh_features",
                                                       "EXT_feature_metadata",
                                                       "EXT_instance_features",
                                                       "CESIUM_primitive_outline",
                                                       "FB_ngon_encoding",
                                                       "FB_geometry_metadata",
                                                       "VRM",
                                                       "NV_materials_"};

bool is_read(std::string_view extension) {
    return std::find(kRead.begin(), kRead.end(), extension) != kRead.end();
}

bool is_without_geometry(std::string_view extension) {
    return std::any_of(kNoGeometry.begin(), kNoGeometry.end(), [=](std::string_view prefix) {
        return extension.starts_with(prefix);
    });
}

/// The names in one of the two lists at the top of the file that are not understood.
std::vector<std::string> strange_names(const GltfFile& file, const char* list) {
    std::vector<std::string> names;
    const auto found = file.json.find(list);
    if (found == file.json.end()) {
        return names;
    }
    if (!found->is_array()) {
        file.fail("", std::string(list) + " is not an array");
    }
    for (const Json& item : *found) {
        const std::string name = item.is_string() ? item.get<std::string>() : item.dump();
        if (!is_read(name) && !is_without_geometry(name)) {
            names.push_back(condensed(name));
        }
    }
    return names;
}

}  // namespace

void check_gltf_extensions(GltfFile& file) {
    for (const std::string& name : strange_names(file, "extensionsRequired")) {
        throw Error(file.name,
                    "requires the extension " + name + ", which earshot does not read",
                    "export without it (plain meshes and accessors)");
    }
    for (const std::string& name : strange_names(file, "extensionsUsed")) {
        file.warnings.push_back({file.name,
                                 "uses the extension " + name +
                                     ", which earshot does not read; if it changes geometry, "
                                     "export without it"});
    }
}

const Json* GltfFile::extension(const Json& object,
                                const char* extension_name,
                                const std::string& element) const {
    const auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object()) {
        return nullptr;
    }
    const auto found = extensions->find(extension_name);
    if (found == extensions->end()) {
        return nullptr;
    }
    if (!found->is_object()) {
        fail(element, std::string(extension_name) + " is not a JSON object");
    }
    return &*found;
}

std::size_t GltfFile::whole_number(const Json& object,
                                   const char* key,
                                   const std::string& element,
                                   std::optional<std::size_t> fallback) const {
    const auto found = object.find(key);
    if (found == object.end() && fallback) {
        return *fallback;
    }
    if (found == object.end()) {
        fail(element, std::string(key) + " is missing");
    }
    if (!found->is_number_unsigned()) {
        fail(element, std::string(key) + " is not a whole number from 0 up");
    }
    return found->get<std::size_t>();
}

}  // namespace earshot::io
