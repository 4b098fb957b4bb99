// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/gltf_file.h"
#include "earshot/io/internal/scene_folder.h"
#include "earshot/io/internal/text.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <array>
#include <optional>

namespace earshot::io {
namespace {

using Bytes = std::vector<unsigned char>;
using Json = nlohmann::json;

Bytes to_bytes(std::string_view text) {
    return {text.begin(), text.end()};
}

int hex_digit(char c) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    const auto lower = static_cast<char>(c >= 'A' && c <= 'F' ? c - 'A' + 'a' : c);
    const std::size_t value = kDigits.find(lower);
    return value == std::string_view::npos ? -1 : static_cast<int>(value);
}

/// RFC 3986 section 2.1; a percent sign that starts no code stands for itself.
std::string percent_decoded(std::string_view uri) {
    std::string decoded;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        if (low >= 0) {
            decoded += static_cast<char>(high * 16 + low);
            i += 2;
        } else {
            decoded += uri[i];
        }
    }
    return decoded;
}

/// RFC 4648 section 4, padding optional. Nothing if a character is not of the alphabet.
std::optional<Bytes> base64_decoded(std::string_view text) {
    constexpr std::string_view kAlphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int, 256> value{};
    value.fill(-1);
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
        value[static_cast<unsigned char>(kAlphabet[i])] = static_cast<int>(i);
    }
    while (text.ends_with('=')) {
        text.remove_suffix(1);
    }
    Bytes bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    unsigned bits = 0;
    int bit_count = 0;
    for (const char c : text) {
        const int six = value[static_cast<unsigned char>(c)];
        if (six < 0) {
            return std::nullopt;
        }
        bits = (bits << 6U | static_cast<unsigned>(six)) & 0xFFFFU;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes.push_back(static_cast<unsigned char>(bits >> static_cast<unsigned>(bit_count)));
        }
    }
    return bytes;
}

bool is_data_uri(std::string_view uri) {
    return lower_case(uri.substr(0, 5)) == "data:";
}

/// The media type of a data URI does not matter for a buffer.
Bytes data_uri_bytes(const GltfFile& file, const std::string& element, std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos || !lower_case(uri.substr(0, comma)).ends_with(";base64")) {
        file.fail(element, "its data URI is not base64");
    }
    std::optional<Bytes> bytes = base64_decoded(uri.substr(comma + 1));
    if (!bytes) {
        file.fail(element, "its data URI holds characters that base64 does not have");
    }
    return std::move(*bytes);
}

/// The file that a URI names. Exporters differ in what they escape, so the name is tried as RFC
/// 3986 has it, as it stands, and with a slash for each backslash.
std::optional<std::filesystem::path> file_of_uri(const GltfFile& file,
                                                 const std::string& element,
                                                 const SceneFolder& folder,
                                                 const std::string& uri) {
    if (uri.find("://") != std::string::npos || lower_case(uri).starts_with("file:")) {
        file.fail(element, condensed(uri) + " is not a file", "store it beside the scene");
    }
    std::string with_slashes = percent_decoded(uri);
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    for (const std::string& name : {percent_decoded(uri), uri, with_slashes}) {
        if (name.empty()) {
            continue;
        }
        if (auto found = folder.find(name, element)) {
            return found;
        }
    }
    return std::nullopt;
}

Bytes external_bytes(const GltfFile& file,
                     const std::string& element,
                     const SceneFolder& folder,
                     const std::string& uri) {
    const auto path = file_of_uri(file, element, folder, uri);
    if (!path) {
        file.fail(
            element, "its file " + condensed(uri) + " is missing", "copy it beside the scene");
    }
    return to_bytes(read_whole_file(*path));
}

/// Per buffer whether an accessor needs it: through its view, through the compressed data of its
/// view, or through Draco data.
class NeededBuffers {
public:
    explicit NeededBuffers(const GltfFile& file)
        : file_(file), needed_(count_of("buffers"), false) {
        for (const Json& accessor : items_of(file.json, "accessors")) {
            need_view_of(accessor);
            if (accessor.contains("sparse")) {
                need_view_of(accessor["sparse"]["indices"]);
                need_view_of(accessor["sparse"]["values"]);
            }
        }
        for (const Json& mesh : items_of(file.json, "meshes")) {
            for (const Json& primitive : items_of(mesh, "primitives")) {
                if (const Json* draco = file.extension(primitive, kDracoExtension, "a primitive")) {
                    need_view_of(*draco);
                }
            }
        }
    }

    bool contains(std::size_t buffer) const { return needed_[buffer]; }

private:
    static const Json& items_of(const Json& object, const char* key) {
        static const Json none = Json::array();
        const auto found = object.find(key);
        return found == object.end() ? none : *found;
    }

    std::size_t count_of(const char* array) const { return items_of(file_.json, array).size(); }

    void need_view_of(const Json& object) {
        const auto view = object.find("bufferView");
        if (view == object.end() || !view->is_number_unsigned() ||
            view->get<std::size_t>() >= count_of("bufferViews")) {
            return;
        }
        const Json& found = file_.json["bufferViews"][view->get<std::size_t>()];
        const Json* compressed = file_.extension(found, kMeshoptExtension, "a bufferView");
        const std::size_t buffer =
            file_.whole_number(compressed != nullptr ? *compressed : found, "buffer", "bufferView");
        if (buffer < needed_.size()) {
            needed_[buffer] = true;
        }
    }

    const GltfFile& file_;
    std::vector<bool> needed_;
};

/// Images are not read, but a scene that names files elsewhere is refused as a whole.
void check_images(const GltfFile& file, const SceneFolder& folder) {
    const auto images = file.json.find("images");
    if (images == file.json.end() || !images->is_array()) {
        return;
    }
    for (std::size_t i = 0; i < images->size(); ++i) {
        const Json& image = (*images)[i];
        if (image.is_object() && image.contains("uri") && image["uri"].is_string() &&
            !is_data_uri(image["uri"].get_ref<const std::string&>())) {
            file_of_uri(file, "image " + std::to_string(i), folder, image["uri"]);
        }
    }
}

}  // namespace

int append_buffer_view(tinygltf::Model& model, Bytes bytes) {
    tinygltf::BufferView view;
    view.buffer = static_cast<int>(model.buffers.size());
    view.byteLength = bytes.size();
    model.buffers.emplace_back();
    model.buffers.back().data = std::move(bytes);
    model.bufferViews.push_back(std::move(view));
    return static_cast<int>(model.bufferViews.size()) - 1;
}

void load_gltf_buffers(GltfFile& file, const SceneFolder& folder, std::string_view binary) {
    check_images(file, folder);
    const auto found = file.json.find("buffers");
    const std::size_t count = found == file.json.end() ? 0 : found->size();
    file.model.buffers.resize(count);
    const NeededBuffers needed(file);
    for (std::size_t i = 0; i < count; ++i) {
        const Json& buffer = (*found)[i];
        const std::string element = "buffer " + std::to_string(i);
        Bytes& data = file.model.buffers[i].data;
        if (!needed.contains(i)) {
            continue;
        }
        if (!buffer.contains("uri")) {
            if (i != 0) {
                file.fail(element, "it has no uri, which only the first buffer of a GLB may lack");
            }
            data = to_bytes(binary);
        } else {
            const auto& uri = buffer["uri"].get_ref<const std::string&>();
            data = is_data_uri(uri) ? data_uri_bytes(file, element, uri)
                                    : external_bytes(file, element, folder, uri);
        }
        const std::size_t length = buffer["byteLength"].get<std::size_t>();
        if (data.size() < length) {
            file.fail(element,
                      "byteLength claims " + std::to_string(length) + " bytes, " +
                          std::to_string(data.size()) + " are there",
                      "copy or export the file again");
        }
        data.resize(length);
        file.size += length;
    }
}

}  // namespace earshot::io
