// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace earshot::io {

class SceneFolder;

/// What the parts of a file may ask for together. Accessors, compressed data and meshes may be
/// named any number of times, so that a few bytes could ask for all time and memory.
enum class GltfCost {
    numbers,        ///< read from accessors; 2^27, or 64 per byte of the file
    decoded_bytes,  ///< of compressed data; 2^29, or 64 per byte of the file
    scene_bytes,    ///< of vertices, triangles and parts; 3 * 2^29, or 32 per byte of the file
};

/// A glTF file whose structure has been checked: every index points at something, every count is a
/// whole number. The bytes of the buffers are checked by those who read them.
struct GltfFile {
    std::string name;       ///< of the file, for errors
    nlohmann::json json;    ///< as written; extras and extensions are read from here
    tinygltf::Model model;  ///< without images and cameras, which no sound needs
    Warnings warnings;
    std::size_t size = 0;                        ///< bytes of the file and of its buffers
    mutable std::array<std::size_t, 3> spent{};  ///< of each GltfCost so far

    /// Throws Error if `element` takes more than is left. `each` times `count` may overflow.
    void spend(const std::string& element,
               GltfCost cost,
               std::size_t count,
               std::size_t each = 1) const;

    /// Throws Error about one element, as in "accessor 3".
    [[noreturn]] void fail(const std::string& element,
                           const std::string& what,
                           const std::string& remedy = "export the file again") const;

    /// The object of an extension of `object`; null if it has none. Throws Error if it is no
    /// object.
    const nlohmann::json* extension(const nlohmann::json& object,
                                    const char* name,
                                    const std::string& element) const;

    /// A whole number from 0 up of an extension's object. Throws Error if it is none, or if it is
    /// missing and there is no `fallback`.
    std::size_t whole_number(const nlohmann::json& object,
                             const char* key,
                             const std::string& element,
                             std::optional<std::size_t> fallback = std::nullopt) const;
};

/// Reads .gltf or .glb (told apart by content) with all buffers that geometry uses, compressed data
/// decoded. Throws Error.
GltfFile read_gltf_file(const std::filesystem::path& file, const SceneFolder& folder);

/// The JSON text and the binary chunk of a file. Both empty views never occur for a valid file.
struct GltfChunks {
    std::string_view json;
    std::string_view binary;
};
GltfChunks split_gltf(std::string_view bytes, const std::string& name);

/// Throws Error for the first thing in the JSON that a reader could trip over.
void check_gltf_structure(const GltfFile& file);

/// Throws Error for a required extension that is not understood, and warns of a used one that may
/// change geometry.
void check_gltf_extensions(GltfFile& file);

/// Fills model.buffers from the binary chunk, data URIs and files in the folder: those that an
/// accessor needs. Throws Error; also for images that lie outside of the folder.
void load_gltf_buffers(GltfFile& file, const SceneFolder& folder, std::string_view binary);

/// Decodes the bufferViews that EXT_meshopt_compression compresses into buffers of their own.
/// Throws Error.
void decode_meshopt_views(GltfFile& file);

/// Decodes the primitives that KHR_draco_mesh_compression compresses into accessors of their own.
/// Throws Error.
void decode_draco_primitives(GltfFile& file);

/// Appends a buffer and a bufferView of all of it, packed, and returns the view's index.
int append_buffer_view(tinygltf::Model& model, std::vector<unsigned char> bytes);

/// One line of at most 160 characters of a library's message.
std::string condensed(std::string_view message);

inline constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";
inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";
inline constexpr const char* kInstancingExtension = "EXT_mesh_gpu_instancing";

}  // namespace earshot::io
