// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <cstddef>
#include <string>

namespace earshot::scenes {

/// A scene as the bytes of a file, and what is in it.
struct GltfFile {
    std::string bytes;
    std::size_t vertices = 0;
    std::size_t triangles = 0;
};

enum class GltfForm {
    text,   ///< .gltf with the buffer inside as base64
    binary  ///< .glb
};

/// glTF 2.0, the same bytes on every machine. `tessellation` as in index_faces.
GltfFile write_gltf(const SceneDraft& draft, GltfForm form, int tessellation = 1);

}  // namespace earshot::scenes
