// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/io/internal/gltf_file.h"
#include "earshot/io/whole_file.h"

#include <array>
#include <optional>

namespace earshot::io {
namespace {

using Bytes = std::vector<unsigned char>;

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

/// The media type of a data URI does not matter for a buffer.
Bytes data_uri_bytes(const GltfFile& file, const std::string& element, std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
        file.fail(element, "its data URI is not base64");
    }
    std::optional<Bytes> bytes = base64_decoded(uri.substr(comma + 1));
    if (!bytes) {
        file.fail(element, "its data URI holds characters that base64 does not have");
    }
    return std::move(*bytes);
}

Bytes external_bytes(const GltfFile& file,
                     const std::string& element,
                     const std::filesystem::path& folder,
                     const std::string& uri) {
    if (uri.find("://") != std::string::npos) {
        file.fail(element, condensed(uri) + " is not a file", "store the buffer beside the scene");
    }
    const std::filesystem::path path = folder / percent_decoded(uri);
    std::error_code ignored;
    if (uri.empty() || !std::filesystem::is_regular_file(path, ignored)) {
        file.fail(element,
                  "its file " + condensed(path.string()) + " is missing",
                  "copy it beside the scene");
    }
    return to_bytes(read_whole_file(path));
}

}  // namespace

void load_gltf_buffers(GltfFile& file,
                       const std::filesystem::path& folder,
                       std::string_view binary) {
    const auto found = file.json.find("buffers");
    const std::size_t count = found == file.json.end() ? 0 : found->size();
    file.model.buffers.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const nlohmann::json& buffer = (*found)[i];
        const std::string element = "buffer " + std::to_string(i);
        Bytes& data = file.model.buffers[i].data;
        if (!buffer.contains("uri")) {
            if (i != 0) {
                file.fail(element, "it has no uri, which only the first buffer of a GLB may lack");
            }
            data = to_bytes(binary);
        } else {
            const auto& uri = buffer["uri"].get_ref<const std::string&>();
            data = uri.starts_with("data:") ? data_uri_bytes(file, element, uri)
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
    }
}

}  // namespace earshot::io
