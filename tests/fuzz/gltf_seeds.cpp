// SPDX-License-Identifier: MIT
#include "fuzz/gltf_seeds.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <memory>
#include <meshoptimizer.h>
#include <stdexcept>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

/// A skinned, morphed and animated triangle.
GltfBuilder moving() {
    GltfBuilder b = one_triangle();
    const int up = b.add_accessor<float>("VEC3", {0, 0, 0, 0, 2, 0, 0, 0, 0});
    b.primitive(0)["targets"] = Json::array({{{"POSITION", up}}});
    b.primitive(0)["attributes"]["JOINTS_0"] =
        b.add_accessor("VEC4", std::vector<std::uint8_t>(12, 0));
    b.primitive(0)["attributes"]["WEIGHTS_0"] =
        b.add_accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    b.add_node({{"name", "joint"}, {"rotation", {0, 0, 0, 1}}});
    const int bind =
        b.add_accessor<float>("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    b.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", bind}}};
    b.json["nodes"][0]["skin"] = 0;
    b.json["meshes"][0]["weights"] = {0.5};
    const int times = b.add_accessor<float>("SCALAR", {0.0F, 1.0F});
    const int slide = b.add_accessor<float>("VEC3", {0, 0, 0, 4, 0, 0});
    const int weights = b.add_accessor<float>("SCALAR", {0, 1});
    const int turns = b.add_accessor<float>("VEC4", {0, 0, 0, 1, 0, 0, 1, 0});
    const int splines =
        b.add_accessor<float>("VEC3", {0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 2, 1, 1, 0, 0, 0});
    b.add_animation(1, "translation", times, slide, "LINEAR");
    Json& animation = b.json["animations"][0];
    const auto add = [&](int values, const char* how, int node, const char* path) {
        animation["channels"].push_back({{"sampler", animation["samplers"].size()},
                                         {"target", {{"node", node}, {"path", path}}}});
        animation["samplers"].push_back(
            {{"input", times}, {"output", values}, {"interpolation", how}});
    };
    add(weights, "STEP", 0, "weights");
    add(turns, "LINEAR", 1, "rotation");
    add(splines, "CUBICSPLINE", 1, "scale");
    b.json["scenes"] = {{{"nodes", {0, 1}}}};
    b.json["scene"] = 0;
    return b;
}

/// Acoustic data of materials and nodes, emitters, names.
GltfBuilder acoustic() {
    GltfBuilder b = one_triangle();
    b.primitive(0)["material"] = 0;
    const Json bands = {{"125", 0.1}, {"1000", 0.25}};
    const Json acoustics = {
        {"absorption", bands}, {"scattering", 0.3}, {"transmission", 0.05}, {"one_sided", true}};
    b.json["materials"] = {{{"name", "back wall"}, {"extras", {{"acoustics", acoustics}}}},
                           {{"name", "text"}, {"extras", {{"acoustics", acoustics.dump()}}}},
                           {{"extras", {{"acoustics", "brick-painted"}}}},
                           {{"name", "flat"}, {"extras", {{"acoustics_absorption", 0.2}}}},
                           {{"extras", {{"acoustics", {{"library", "carpet-thin"}}}}}}};
    b.add_node({{"name", "s"},
                {"translation", {1, 2, 3}},
                {"extras", {{"acoustics", {{"role", "source"}, {"directivity", "cardioid"}}}}}});
    b.add_node({{"name", "l"},
                {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 2, 1, 1}},
                {"extras", {{"acoustics", {{"role", "listener"}}}}}});
    b.json["extensionsUsed"] = {"KHR_audio_emitter"};
    b.json["extensions"]["KHR_audio_emitter"]["emitters"] = {{{"type", "positional"}}};
    b.add_node({{"name", "e"}, {"extensions", {{"KHR_audio_emitter", {{"emitter", 0}}}}}});
    b.add_node({{"name", "root"}, {"children", {0, 1, 2, 3}}, {"scale", {1, -1, 2}}});
    b.json["scenes"] = {{{"nodes", {4}}}};
    return b;
}

/// Strips, fans, no indices, sparse values, quantised positions, strides, unused primitives.
GltfBuilder accessors() {
    GltfBuilder b = one_triangle();
    const int square =
        b.add_accessor<std::int16_t>("VEC3", {0, 0, 0, 9, 0, 0, 0, 9, 0, 9, 9, 1}, true);
    const int order = b.add_accessor<std::uint8_t>("SCALAR", {0, 1, 2, 3});
    const Json attributes = {{"POSITION", square}};
    for (const int mode : {5, 6, 1}) {
        b.json["meshes"][0]["primitives"].push_back(
            {{"attributes", attributes}, {"indices", order}, {"mode", mode}});
    }
    const int places = b.add_view(GltfBuilder::packed<std::uint16_t>({1, 2}));
    const int values = b.add_view(GltfBuilder::packed<float>({1, 0, 0, 0, 1, 0}));
    b.json["accessors"].push_back({{"componentType", 5126},
                                   {"count", 3},
                                   {"type", "VEC3"},
                                   {"sparse",
                                    {{"count", 2},
                                     {"indices", {{"bufferView", places}, {"componentType", 5123}}},
                                     {"values", {{"bufferView", values}}}}}});
    b.add_node({{"mesh", b.add_mesh(static_cast<int>(b.json["accessors"].size()) - 1)}});
    const int strided = b.add_view(std::string(4 * 24, '\1'));
    b.json["bufferViews"].back()["byteStride"] = 24;
    b.json["accessors"].push_back({{"bufferView", strided},
                                   {"byteOffset", 4},
                                   {"componentType", 5126},
                                   {"count", 4},
                                   {"type", "VEC3"}});
    b.json["meshes"][1]["primitives"].push_back(
        {{"attributes", {{"POSITION", b.json["accessors"].size() - 1}}}, {"mode", 5}});
    b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    return b;
}

GltfBuilder instances() {
    GltfBuilder b = one_triangle();
    const Json attributes = {
        {"TRANSLATION", b.add_accessor<float>("VEC3", {0, 0, 0, 0, 5, 0})},
        {"ROTATION", b.add_accessor<std::int8_t>("VEC4", {0, 0, 0, 127, 127, 0, 0, 0}, true)},
        {"SCALE", b.add_accessor<float>("VEC3", {1, 1, 1, 2, 2, -2})}};
    b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    return b;
}

/// A grid of 3 x 3 squares.
const std::vector<float> kPoints{0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 0, 1, 0, 1,
                                 1, 1, 2, 1, 1, 3, 1, 0, 0, 2, 0, 1, 2, 1, 2, 2,
                                 1, 3, 2, 0, 0, 3, 0, 1, 3, 0, 2, 3, 0, 3, 3, 0};
std::vector<std::uint32_t> grid_indices() {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y < 3; ++y) {
        for (std::uint32_t a = 4 * y; a < 4 * y + 3; ++a) {
            indices.insert(indices.end(), {a, a + 1, a + 5, a, a + 5, a + 4});
        }
    }
    return indices;
}

int add_compressed(GltfBuilder& b,
                   const std::vector<unsigned char>& bytes,
                   std::size_t count,
                   std::size_t stride,
                   const Json& mode_and_filter) {
    const int raw = b.add_view({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    Json extension = mode_and_filter;
    extension.update({{"buffer", 0},
                      {"byteOffset", b.json["bufferViews"][raw]["byteOffset"]},
                      {"byteLength", bytes.size()},
                      {"byteStride", stride},
                      {"count", count}});
    b.json["bufferViews"].push_back({{"buffer", 0},
                                     {"byteLength", count * stride},
                                     {"extensions", {{"EXT_meshopt_compression", extension}}}});
    return raw + 1;
}

GltfBuilder meshopt(bool is_sequence, bool is_filtered) {
    GltfBuilder b;
    const std::size_t vertices = kPoints.size() / 3;
    const std::vector<std::uint32_t> indices = grid_indices();
    std::vector<std::uint32_t> filtered(kPoints.size());
    meshopt_encodeFilterExp(filtered.data(), vertices, 12, 15, kPoints.data());
    const void* source = is_filtered ? static_cast<const void*>(filtered.data()) : kPoints.data();
    std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(vertices, 12));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), source, vertices, 12));
    Json mode = {{"mode", "ATTRIBUTES"}};
    if (is_filtered) {
        mode["filter"] = "EXPONENTIAL";
    }
    const int positions = add_compressed(b, bytes, vertices, 12, mode);
    b.json["bufferViews"][positions]["byteStride"] = 12;
    bytes.resize(1000);
    bytes.resize(is_sequence ? meshopt_encodeIndexSequence(
                                   bytes.data(), bytes.size(), indices.data(), indices.size())
                             : meshopt_encodeIndexBuffer(
                                   bytes.data(), bytes.size(), indices.data(), indices.size()));
    const int triangles = add_compressed(
        b, bytes, indices.size(), 4, {{"mode", is_sequence ? "INDICES" : "TRIANGLES"}});
    b.json["accessors"] = {
        {{"bufferView", positions}, {"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}},
        {{"bufferView", triangles},
         {"componentType", 5125},
         {"count", indices.size()},
         {"type", "SCALAR"}}};
    b.add_node({{"mesh", b.add_mesh(0, 1)}});
    b.json["extensionsUsed"] = {"EXT_meshopt_compression"};
    return b;
}

GltfBuilder draco(bool is_sequential) {
    const std::vector<std::uint32_t> indices = grid_indices();
    draco::TriangleSoupMeshBuilder soup;
    soup.Start(static_cast<int>(indices.size() / 3));
    const int position =
        soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        soup.SetAttributeValuesForFace(position,
                                       draco::FaceIndex(static_cast<std::uint32_t>(i / 3)),
                                       &kPoints[3 * indices[i]],
                                       &kPoints[3 * indices[i + 1]],
                                       &kPoints[3 * indices[i + 2]]);
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(is_sequential ? draco::MESH_SEQUENTIAL_ENCODING
                                            : draco::MESH_EDGEBREAKER_ENCODING);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(*soup.Finalize(), &buffer).ok()) {
        throw std::runtime_error("Draco cannot encode the grid");
    }
    GltfBuilder b;
    const int view = b.add_view({buffer.data(), buffer.size()});
    b.json["accessors"] = {
        {{"componentType", 5126}, {"count", kPoints.size() / 3}, {"type", "VEC3"}},
        {{"componentType", 5123}, {"count", indices.size()}, {"type", "SCALAR"}}};
    b.add_node({{"mesh", b.add_mesh(0, 1)}});
    b.primitive(0)["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
    b.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    return b;
}

}  // namespace

std::vector<GltfSeed> gltf_seeds() {
    return {{"accessors", accessors()},
            {"acoustic", acoustic()},
            {"draco-edgebreaker", draco(false)},
            {"draco-sequential", draco(true)},
            {"instances", instances()},
            {"meshopt-filtered", meshopt(false, true)},
            {"meshopt-sequence", meshopt(true, false)},
            {"moving", moving()},
            {"triangle", one_triangle()}};
}

}  // namespace earshot::test
