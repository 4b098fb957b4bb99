// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_file.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/json_depth.h"
#include "earshot/io/internal/text.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "glTF numbers are read as they stand");

constexpr std::string_view kMagic = "glTF";
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;
constexpr const char* kTruncated = "copy or export the file again";

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + offset, sizeof word);
    return word;
}

/// Removes a chunk from the front of `rest`.
std::string_view take_chunk(std::string_view& rest, std::uint32_t type, const std::string& name) {
    if (rest.size() < 8) {
        throw Error(name, "is truncated: a GLB chunk header is missing", kTruncated);
    }
    const std::size_t length = word_at(rest, 0);
    if (length > rest.size() - 8) {
        throw Error(name,
                    "is truncated: a GLB chunk claims " + std::to_string(length) + " bytes, " +
                        std::to_string(rest.size() - 8) + " are left",
                    kTruncated);
    }
    const std::string_view chunk =
        word_at(rest, 4) == type ? rest.substr(8, length) : std::string_view();
    rest.remove_prefix(8 + length);
    return chunk;
}

Json parse_json(std::string_view text, const std::string& name) {
    if (exceeds_json_depth(text)) {
        throw Error(name,
                    "JSON is nested more than " + std::to_string(kMaxJsonDepth) + " levels deep",
                    "export the file again");
    }
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {
        throw Error(
            name, "JSON cannot be read: " + condensed(error.what()), "correct the JSON text");
    }
}

/// JSON has one kind of number: 6.0 is the whole number 6. Extras are the user's own and stay.
void write_whole_numbers_whole(Json& json) {
    if (json.is_number_float()) {
        constexpr double kMaxExact = 9007199254740992.0;  // 2^53
        const double value = json.get<double>();
        const bool is_whole = value == std::trunc(value) && std::abs(value) < kMaxExact;
        if (is_whole && value >= 0.0 && !std::signbit(value)) {
            json = static_cast<std::uint64_t>(value);
        } else if (is_whole && value < 0.0) {
            json = static_cast<std::int64_t>(value);
        }
    } else if (json.is_array()) {
        for (Json& item : json) {
            write_whole_numbers_whole(item);
        }
    } else if (json.is_object()) {
        for (const auto& [key, item] : json.items()) {
            if (key != "extras") {
                write_whole_numbers_whole(item);
            }
        }
    }
}

void drop_members(Json& json, std::initializer_list<const char*> names) {
    if (json.is_object()) {
        for (const char* name : names) {
            json.erase(name);
        }
    }
    if (json.is_structured()) {
        for (Json& item : json) {
            drop_members(item, names);
        }
    }
}

/// What concerns geometry and motion. Images may be absent and cameras do not sound; buffers are
/// read by load_gltf_buffers, materials by acoustics_extras.
std::string structure_text(const Json& json) {
    Json kept = Json::object();
    for (const char* key : {"asset",
                            "scene",
                            "scenes",
                            "nodes",
                            "meshes",
                            "skins",
                            "animations",
                            "accessors",
                            "bufferViews"}) {
        if (json.contains(key)) {
            kept[key] = json[key];
        }
    }
    drop_members(kept, {"extensions", "extras"});
    // tinygltf refuses indices without a bufferView, which are all zeros but for sparse values.
    if (kept.contains("meshes")) {
        for (Json& mesh : kept["meshes"]) {
            if (mesh.contains("primitives")) {
                for (Json& primitive : mesh["primitives"]) {
                    primitive.erase("indices");
                }
            }
        }
    }
    return kept.dump();
}

/// Puts back what structure_text() holds back.
void restore_indices(GltfFile& file) {
    for (std::size_t mesh = 0; mesh < file.model.meshes.size(); ++mesh) {
        std::vector<tinygltf::Primitive>& primitives = file.model.meshes[mesh].primitives;
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            primitives[i].indices = file.json["meshes"][mesh]["primitives"][i].value("indices", -1);
        }
    }
}

}  // namespace

std::string condensed(std::string_view message) {
    constexpr std::size_t kMaxLength = 160;
    if (message.starts_with("[json.exception")) {
        message.remove_prefix(std::min(message.size(), message.find("] ") + 2));
    }
    std::string line;
    for (const char c : message.substr(0, kMaxLength)) {
        const bool is_blank = static_cast<unsigned char>(c) <= ' ';
        if (!is_blank || (!line.empty() && line.back() != ' ')) {
            line += is_blank ? ' ' : c;
        }
    }
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) {
        line.pop_back();
    }
    return message.size() > kMaxLength ? line + " ..." : line;
}

void GltfFile::fail(const std::string& element,
                    const std::string& what,
                    const std::string& remedy) const {
    throw Error(name, element.empty() ? what : element + ": " + what, remedy);
}

void GltfFile::spend(const std::string& element,
                     GltfCost cost,
                     std::size_t count,
                     std::size_t each) const {
    struct Limit {
        std::size_t amount;
        std::size_t per_byte;
        const char* what;
    };
    constexpr std::array<Limit, 3> kLimits{
        {{std::size_t{1} << 27U, 64, " numbers of accessors"},
         {std::size_t{1} << 29U, 64, " bytes of decoded data"},
         {std::size_t{3} << 29U, 32, " bytes of vertices and triangles"}}};
    const auto kind = static_cast<std::size_t>(cost);
    const Limit& limit = kLimits[kind];
    const std::size_t largest = std::max(limit.amount, limit.per_byte * size);
    const std::size_t left = largest - spent[kind];
    if (each != 0 && count > left / each) {
        fail(element,
             "with it the file asks for more than " + std::to_string(largest) + limit.what +
                 ", which its size does not warrant",
             "split the scene");
    }
    spent[kind] += count * each;
}

namespace {

std::string_view decoded_json(std::string_view bytes, const std::string& name) {
    try {
        return decoded_text(bytes, name);
    } catch (const Error& error) {
        throw Error(name, std::string("JSON cannot be read: it ") + error.what(), error.remedy());
    }
}

}  // namespace

GltfChunks split_gltf(std::string_view bytes, const std::string& name) {
    if (!bytes.starts_with(kMagic)) {
        return {decoded_json(bytes, name), {}};
    }
    if (bytes.size() < 12) {
        throw Error(name, "is truncated: the GLB header is incomplete", kTruncated);
    }
    const std::uint32_t version = word_at(bytes, 4);
    if (version != 2) {
        throw Error(name,
                    "GLB version " + std::to_string(version) + " is not understood",
                    "export it as glTF 2.0");
    }
    const std::size_t length = word_at(bytes, 8);
    if (length > bytes.size() || length < 12) {
        throw Error(name,
                    "is truncated: the header claims " + std::to_string(length) +
                        " bytes, the file has " + std::to_string(bytes.size()),
                    kTruncated);
    }
    std::string_view rest = bytes.substr(12, length - 12);
    GltfChunks chunks;
    chunks.json = take_chunk(rest, kJsonChunk, name);
    if (chunks.json.empty()) {
        throw Error(name, "the first GLB chunk is not JSON", "export the file again");
    }
    if (!rest.empty()) {
        chunks.binary = take_chunk(rest, kBinaryChunk, name);
    }
    return chunks;
}

GltfFile read_gltf_file(const std::filesystem::path& path, const SceneFolder& folder) {
    const std::string bytes = read_whole_file(path);
    GltfFile file;
    file.name = path.string();
    file.size = bytes.size();
    const GltfChunks chunks = split_gltf(bytes, file.name);
    file.json = parse_json(chunks.json, file.name);
    write_whole_numbers_whole(file.json);
    check_gltf_structure(file);
    check_gltf_extensions(file);

    tinygltf::TinyGLTF reader;
    std::string error;
    std::string warning;
    const std::string text = structure_text(file.json);
    if (text.size() > std::numeric_limits<unsigned>::max()) {
        throw Error(file.name, "its JSON is longer than 4 GB", "store numbers in binary buffers");
    }
    const bool is_read = reader.LoadASCIIFromString(
        &file.model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), "");
    if (!is_read) {
        throw Error(file.name, condensed(error), "export the file again");
    }
    restore_indices(file);
    load_gltf_buffers(file, folder, chunks.binary);
    decode_meshopt_views(file);
    decode_draco_primitives(file);
    return file;
}

}  // namespace earshot::io
