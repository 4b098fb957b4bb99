// SPDX-License-Identifier: MIT
#include "earshot/scenes/gltf_writer.h"

#include "earshot/scenes/indexed_mesh.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace earshot::scenes {

namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// glTF 2.0, section 5: names of numbers.
constexpr int kFloat = 5126;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kVertices = 34962;  // bufferView.target
constexpr int kIndices = 34963;
constexpr std::size_t kMaxShortVertices = 65535;  // the index 65535 is not allowed

std::string base64(const std::string& bytes) {
    constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        std::uint32_t group = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const bool there = at + i < bytes.size();
            group = group << 8 | (there ? static_cast<unsigned char>(bytes[at + i]) : 0U);
        }
        for (std::size_t i = 0; i < 4; ++i) {
            const bool there = at + i <= bytes.size();
            text += there ? kLetters[group >> (18 - 6 * i) & 63] : '=';
        }
    }
    return text;
}

Json vector_of(const Vec3& vector) {
    return {vector.x, vector.y, vector.z};
}

// Collects the parts of a file.
class Writer {
public:
    explicit Writer(const SceneDraft& draft) : draft_(draft) {
        for (const SurfaceMaterial& material : draft.materials) {
            add_material(material);
        }
    }

    void add_node(const DraftNode& node, int tessellation) {
        Json json = {{"name", node.name}};
        if (node.translation != Vec3(0.0)) {
            json["translation"] = vector_of(node.translation);
        }
        if (!node.faces.empty()) {
            json["mesh"] = meshes_.size();
            add_mesh(node, tessellation);
        }
        if (node.role != Role::none) {
            json["extras"]["acoustics"]["role"] = node.role == Role::source ? "source" : "listener";
        }
        add_animation(node);
        nodes_.push_back(json);
    }

    std::size_t vertices() const { return vertices_; }
    std::size_t triangles() const { return triangles_; }

    std::string text() const { return document(true).dump(1) + "\n"; }

    std::string binary() const {
        std::string json = document(false).dump();
        json.resize((json.size() + 3) / 4 * 4, ' ');
        std::string buffer = buffer_;
        buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
        std::string file = "glTF";
        const auto number = [&](std::size_t value) {
            const auto word = static_cast<std::uint32_t>(value);
            file.append(reinterpret_cast<const char*>(&word), sizeof word);
        };
        number(2);
        number(12 + 8 + json.size() + 8 + buffer.size());
        number(json.size());
        file += "JSON" + json;
        number(buffer.size());
        file += std::string("BIN\0", 4) + buffer;
        return file;
    }

private:
    static Json by_octave(const Octaves& values) {
        Json json;
        for (std::size_t octave = 0; octave < values.size(); ++octave) {
            json[std::to_string(125U << octave)] = values[octave];
        }
        return json;
    }

    void add_material(const SurfaceMaterial& material) {
        Json acoustics;
        if (material.library.empty()) {
            acoustics["absorption"] = material.absorption;
            acoustics["scattering"] = material.scattering;
        } else {
            acoustics["library"] = material.library;
        }
        if (material.row_absorption) {
            acoustics["absorption"] = by_octave(*material.row_absorption);
        }
        if (material.row_scattering) {
            acoustics["scattering"] = by_octave(*material.row_scattering);
        }
        const auto& [red, green, blue] = material.colour;
        materials_.push_back({{"name", material.name},
                              {"pbrMetallicRoughness",
                               {{"baseColorFactor", {red, green, blue, 1.0}},
                                {"metallicFactor", 0.0},
                                {"roughnessFactor", 0.9}}},
                              {"extras", {{"acoustics", acoustics}}}});
    }

    template <typename T>
    std::size_t add_view(const std::vector<T>& values, int target) {
        const std::size_t length = values.size() * sizeof(T);
        Json view = {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", length}};
        if (target != 0) {
            view["target"] = target;
        }
        views_.push_back(view);
        buffer_.append(reinterpret_cast<const char*>(values.data()), length);
        buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
        return views_.size() - 1;
    }

    std::size_t add_vectors(const std::vector<std::array<float, 3>>& vectors) {
        std::array<float, 3> least = vectors.front();
        std::array<float, 3> most = vectors.front();
        for (const auto& vector : vectors) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                least[axis] = std::min(least[axis], vector[axis]);
                most[axis] = std::max(most[axis], vector[axis]);
            }
        }
        accessors_.push_back({{"bufferView", add_view(vectors, kVertices)},
                              {"componentType", kFloat},
                              {"count", vectors.size()},
                              {"type", "VEC3"},
                              {"min", least},
                              {"max", most}});
        return accessors_.size() - 1;
    }

    std::size_t add_indices(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                            bool as_shorts) {
        std::size_t view = 0;
        if (as_shorts) {
            std::vector<std::uint16_t> shorts;
            for (const auto& triangle : triangles) {
                for (const std::uint32_t index : triangle) {
                    shorts.push_back(static_cast<std::uint16_t>(index));
                }
            }
            view = add_view(shorts, kIndices);
        } else {
            view = add_view(triangles, kIndices);
        }
        accessors_.push_back({{"bufferView", view},
                              {"componentType", as_shorts ? kUnsignedShort : kUnsignedInt},
                              {"count", 3 * triangles.size()},
                              {"type", "SCALAR"}});
        return accessors_.size() - 1;
    }

    std::size_t add_numbers(const std::vector<double>& numbers, const char* type, int width) {
        std::vector<float> singles(numbers.size());
        std::transform(numbers.begin(), numbers.end(), singles.begin(), [](double number) {
            return static_cast<float>(number);
        });
        Json accessor = {{"bufferView", add_view(singles, 0)},
                         {"componentType", kFloat},
                         {"count", singles.size() / static_cast<std::size_t>(width)},
                         {"type", type}};
        if (width == 1) {
            accessor["min"] = {*std::min_element(singles.begin(), singles.end())};
            accessor["max"] = {*std::max_element(singles.begin(), singles.end())};
        }
        accessors_.push_back(accessor);
        return accessors_.size() - 1;
    }

    void add_mesh(const DraftNode& node, int tessellation) {
        const IndexedMesh mesh = index_faces(node, draft_.materials.size(), tessellation);
        vertices_ += mesh.positions.size();
        triangles_ += mesh.triangle_count();
        const std::size_t positions = add_vectors(mesh.positions);
        Json targets = Json::array();
        for (const auto& displacement : mesh.displacements) {
            targets.push_back({{"POSITION", add_vectors(displacement)}});
        }
        Json primitives = Json::array();
        for (std::size_t material = 0; material < mesh.triangles.size(); ++material) {
            if (mesh.triangles[material].empty()) {
                continue;
            }
            Json primitive = {
                {"attributes", {{"POSITION", positions}}},
                {"indices",
                 add_indices(mesh.triangles[material], mesh.positions.size() <= kMaxShortVertices)},
                {"material", material}};
            if (!targets.empty()) {
                primitive["targets"] = targets;
            }
            primitives.push_back(primitive);
        }
        Json json = {{"name", node.name}, {"primitives", primitives}};
        if (!targets.empty()) {
            json["weights"] = node.weights.weights.front();
        }
        meshes_.push_back(json);
    }

    void add_animation(const DraftNode& node) {
        if (!node.rotation.times.empty()) {
            std::vector<double> values;
            for (const glm::dquat& q : node.rotation.rotations) {
                values.insert(values.end(), {q.x, q.y, q.z, q.w});
            }
            add_channel("rotation", node.rotation.times, values, "VEC4", 4);
        }
        if (!node.weights.times.empty()) {
            std::vector<double> values;
            for (const auto& weights : node.weights.weights) {
                values.insert(values.end(), weights.begin(), weights.end());
            }
            add_channel("weights", node.weights.times, values, "SCALAR", 1);
        }
    }

    // Moves the node that is about to be added.
    void add_channel(const char* path,
                     const std::vector<double>& times,
                     const std::vector<double>& values,
                     const char* type,
                     int width) {
        samplers_.push_back({{"input", add_numbers(times, "SCALAR", 1)},
                             {"interpolation", "LINEAR"},
                             {"output", add_numbers(values, type, width)}});
        channels_.push_back({{"sampler", samplers_.size() - 1},
                             {"target", {{"node", nodes_.size()}, {"path", path}}}});
    }

    Json document(bool with_buffer) const {
        Json roots = Json::array();
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            roots.push_back(node);
        }
        Json buffer = {{"byteLength", buffer_.size()}};
        if (with_buffer) {
            buffer["uri"] = "data:application/octet-stream;base64," + base64(buffer_);
        }
        const Json scene = {{"name", draft_.name}, {"nodes", roots}};
        Json json = {{"asset", {{"version", "2.0"}, {"generator", "earshot_scenes"}}},
                     {"scene", 0},
                     {"scenes", Json::array({scene})},
                     {"nodes", nodes_},
                     {"meshes", meshes_},
                     {"materials", materials_},
                     {"accessors", accessors_},
                     {"bufferViews", views_},
                     {"buffers", Json::array({buffer})}};
        if (!channels_.empty()) {
            const Json animation = {
                {"name", draft_.name}, {"channels", channels_}, {"samplers", samplers_}};
            json["animations"] = Json::array({animation});
        }
        return json;
    }

    const SceneDraft& draft_;
    std::string buffer_;
    std::size_t vertices_ = 0;
    std::size_t triangles_ = 0;
    Json nodes_ = Json::array();
    Json meshes_ = Json::array();
    Json materials_ = Json::array();
    Json accessors_ = Json::array();
    Json views_ = Json::array();
    Json channels_ = Json::array();
    Json samplers_ = Json::array();
};

}  // namespace

GltfFile write_gltf(const SceneDraft& draft, GltfForm form, int tessellation) {
    Writer writer(draft);
    for (const DraftNode& node : draft.nodes) {
        writer.add_node(node, tessellation);
    }
    return {form == GltfForm::text ? writer.text() : writer.binary(),
            writer.vertices(),
            writer.triangles()};
}

}  // namespace earshot::scenes
