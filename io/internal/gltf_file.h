// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <filesystem>
#include <string>

namespace earshot::io {

/// A glTF file whose structure has been checked: every index points at something, every count is a
/// whole number. What the bytes of the buffers say is checked by those who read them.
struct GltfFile {
    std::string name;       ///< of the file, for errors
    nlohmann::json json;    ///< as written; extras and extensions are read from here
    tinygltf::Model model;  ///< without images and cameras, which no sound needs

    /// Throws Error about one element, as in "accessor 3".
    [[noreturn]] void fail(const std::string& element,
                           const std::string& what,
                           const std::string& remedy = "export the file again") const;
};

/// Reads .gltf or .glb (told apart by content) with all its buffers. Throws Error.
GltfFile read_gltf_file(const std::filesystem::path& file);

/// The JSON text and the binary chunk of a file. Both empty views never occur for a valid file.
struct GltfChunks {
    std::string_view json;
    std::string_view binary;
};
GltfChunks split_gltf(std::string_view bytes, const std::string& name);

/// Throws Error for the first thing in the JSON that a reader could trip over.
void check_gltf_structure(const GltfFile& file);

/// Fills model.buffers from the binary chunk, data URIs and files beside. Throws Error.
void load_gltf_buffers(GltfFile& file,
                       const std::filesystem::path& folder,
                       std::string_view binary);

/// One line of at most 160 characters of a library's message.
std::string condensed(std::string_view message);

}  // namespace earshot::io
