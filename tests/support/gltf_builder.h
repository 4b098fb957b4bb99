// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::test {

/// Makes small glTF files. `json` may be changed freely between adding and writing.
class GltfBuilder {
public:
    using Json = nlohmann::json;

    Json json = {{"asset", {{"version", "2.0"}}}};
    std::string bytes;  ///< of the only buffer

    /// Appends raw bytes as a bufferView and returns its index.
    int add_view(std::string_view data) {
        bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size()}});
        bytes += data;
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }

    template <typename T>
    static std::string packed(const std::vector<T>& numbers) {
        std::string data(numbers.size() * sizeof(T), '\0');
        std::memcpy(data.data(), numbers.data(), data.size());
        return data;
    }

    /// An accessor of tightly packed numbers of the C++ type, `type` as in "VEC3".
    template <typename T>
    int add_accessor(const std::string& type,
                     const std::vector<T>& numbers,
                     bool normalized = false) {
        const std::size_t width = type == "SCALAR" ? 1
                                  : type == "VEC3" ? 3
                                  : type == "VEC4" ? 4
                                                   : 16;
        json["accessors"].push_back({{"bufferView", add_view(packed(numbers))},
                                     {"componentType", component_type<T>()},
                                     {"count", numbers.size() / width},
                                     {"type", type}});
        if (normalized) {
            json["accessors"].back()["normalized"] = true;
        }
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    /// A mesh of one primitive; -1: not indexed.
    int add_mesh(int positions, int indices = -1) {
        Json primitive = {{"attributes", {{"POSITION", positions}}}};
        if (indices >= 0) {
            primitive["indices"] = indices;
        }
        json["meshes"].push_back({{"primitives", Json::array({primitive})}});
        return static_cast<int>(json["meshes"].size()) - 1;
    }

    int add_node(const Json& node) {
        json["nodes"].push_back(node);
        return static_cast<int>(json["nodes"].size()) - 1;
    }

    Json& primitive(int mesh) {
        return json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0];
    }

    /// An animation of one channel.
    void add_animation(
        int node, const std::string& path, int times, int values, const std::string& how) {
        json["animations"].push_back(
            {{"samplers", {{{"input", times}, {"output", values}, {"interpolation", how}}}},
             {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
    }

    std::string glb() const {
        Json whole = json;
        if (whole.is_object() && !whole.contains("buffers")) {
            whole["buffers"] = {{{"byteLength", bytes.size()}}};
        }
        return glb_of(whole.dump(), bytes);
    }

    /// Text with the buffer in a file of that name beside, or as a data URI.
    std::string gltf(const std::string& buffer_file = "") const {
        Json whole = json;
        const std::string uri = buffer_file.empty()
                                    ? "data:application/octet-stream;base64," + base64(bytes)
                                    : buffer_file;
        whole["buffers"] = {{{"byteLength", bytes.size()}, {"uri", uri}}};
        return whole.dump();
    }

    static std::string glb_of(std::string text, std::string binary) {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        const auto total = static_cast<std::uint32_t>(28 + text.size() + binary.size());
        return "glTF" + word(2) + word(total) + word(static_cast<std::uint32_t>(text.size())) +
               word(0x4E4F534A) + text + word(static_cast<std::uint32_t>(binary.size())) +
               word(0x004E4942) + binary;
    }

    static std::string word(std::uint32_t value) {
        std::string data(4, '\0');
        std::memcpy(data.data(), &value, 4);
        return data;
    }

    static std::string base64(std::string_view data) {
        constexpr std::string_view kAlphabet =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t i = 0; i < data.size(); i += 3) {
            std::array<unsigned, 3> three{};
            const std::size_t count = std::min<std::size_t>(3, data.size() - i);
            for (std::size_t k = 0; k < count; ++k) {
                three[k] = static_cast<unsigned char>(data[i + k]);
            }
            const unsigned bits = three[0] << 16U | three[1] << 8U | three[2];
            for (unsigned k = 0; k < 4; ++k) {
                text += k <= count ? kAlphabet[bits >> (18U - 6U * k) & 63U] : '=';
            }
        }
        return text;
    }

private:
    template <typename T>
    static int component_type() {
        return std::is_same_v<T, std::int8_t>     ? 5120
               : std::is_same_v<T, std::uint8_t>  ? 5121
               : std::is_same_v<T, std::int16_t>  ? 5122
               : std::is_same_v<T, std::uint16_t> ? 5123
               : std::is_same_v<T, std::uint32_t> ? 5125
                                                  : 5126;
    }
};

/// One triangle on one node, with everything a test may want to change.
inline GltfBuilder one_triangle() {
    GltfBuilder builder;
    const int positions =
        builder.add_accessor<float>("VEC3", {0.1F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.3F});
    const int indices = builder.add_accessor<std::uint16_t>("SCALAR", {0, 1, 2});
    builder.add_node({{"mesh", builder.add_mesh(positions, indices)}});
    return builder;
}

}  // namespace earshot::test
