// SPDX-License-Identifier: MIT
// Extensions that hold geometry. Compressed data is made by the encoders of the same libraries,
// without loss, so that the surface that comes out is known to the last bit.
#include "earshot/io/scene_file.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/gltf_builder.h"
#include "triangle_soup.h"
#include <algorithm>
#include <array>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <functional>
#include <limits>
#include <memory>
#include <meshoptimizer.h>
#include <utility>

namespace earshot::io {
namespace {

using geometry::Vec3;
using test::GltfBuilder;
using Json = nlohmann::json;

ReadSoup read(const std::string& bytes, double time = 0.0) {
    return read_soup("a.glb", bytes, time);
}

void expect_refused(const GltfBuilder& builder, const std::string& part) {
    const ReadSoup result = read(builder.glb());
    EXPECT_NE(result.error.find(part), std::string::npos) << part << "\n" << result.error;
}

/// The numbers of a grid of n x n squares in the plane z = 0, bent a little.
struct Grid {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;

    explicit Grid(std::uint32_t n) {
        for (std::uint32_t y = 0; y <= n; ++y) {
            for (std::uint32_t x = 0; x <= n; ++x) {
                positions.insert(positions.end(),
                                 {static_cast<float>(x) * 0.25F,
                                  static_cast<float>(y) * 0.1F,
                                  static_cast<float>(x * y % 5) * 0.01F});
            }
        }
        for (std::uint32_t y = 0; y < n; ++y) {
            for (std::uint32_t x = 0; x < n; ++x) {
                const std::uint32_t a = y * (n + 1) + x;
                const std::uint32_t b = a + n + 1;
                indices.insert(indices.end(), {a, a + 1, b + 1, a, b + 1, b});
            }
        }
    }

    Soup soup() const {
        const auto point = [&](std::uint32_t i) {
            return Vec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
        };
        Soup triangles;
        for (std::size_t i = 0; i < indices.size(); i += 3) {
            triangles.push_back({point(indices[i]), point(indices[i + 1]), point(indices[i + 2])});
        }
        return triangles;
    }
};

// Instances.

/// One triangle under a node at x = 10, with instances.
GltfBuilder instanced(const std::vector<float>& translations) {
    GltfBuilder builder = test::one_triangle();
    builder.json["nodes"][0]["translation"] = {10, 0, 0};
    const int accessor = builder.add_accessor<float>("VEC3", translations);
    builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", accessor}};
    builder.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    return builder;
}

Json& instance_attributes(GltfBuilder& builder) {
    return builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
}

TEST(GltfInstances, StandWhereTheirAttributesPutThem) {
    const ReadSoup result = read(instanced({0, 0, 0, 0, 5, 0, 1, 0, -2}).glb());
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.warnings, "");
    ASSERT_EQ(result.soup.size(), 3U);
    EXPECT_EQ(result.soup[0][1], Vec3(11, 0, 0));
    EXPECT_EQ(result.soup[1][1], Vec3(11, 5, 0));
    EXPECT_EQ(result.soup[2][1], Vec3(12, 0, -2));
}

TEST(GltfInstances, MayBeRequired) {
    GltfBuilder builder = instanced({0, 0, 0, 0, 5, 0});
    builder.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    EXPECT_EQ(read(builder.glb()).soup.size(), 2U);
}

TEST(GltfInstances, ScaleThenTurnThenMove) {
    GltfBuilder builder = instanced({0, 0, 1});
    // 90 degrees about z, as normalised bytes; the corner (1, 0, 0) goes to (0, 3, 1).
    instance_attributes(builder)["ROTATION"] =
        builder.add_accessor<std::int8_t>("VEC4", {0, 0, 127, 127}, true);
    instance_attributes(builder)["SCALE"] = builder.add_accessor<float>("VEC3", {3, 1, 1});
    const ReadSoup result = read(builder.glb());
    ASSERT_EQ(result.soup.size(), 1U) << result.error;
    const Vec3 difference = result.soup[0][1] - Vec3(10, 3, 1);
    EXPECT_LT(glm::dot(difference, difference), 1e-24);
}

TEST(GltfInstances, MoveWithTheirNode) {
    GltfBuilder builder = instanced({0, 0, 0, 0, 5, 0});
    const int times = builder.add_accessor<float>("SCALAR", {0.0F, 1.0F});
    const int slide = builder.add_accessor<float>("VEC3", {0, 0, 0, 4, 0, 0});
    builder.json["animations"] = Json::array();
    builder.add_animation(0, "translation", times, slide, "LINEAR");
    const ReadSoup result = read(builder.glb(), 0.5);
    ASSERT_EQ(result.soup.size(), 2U) << result.error;
    EXPECT_EQ(result.soup[0][1], Vec3(3, 0, 0));
    EXPECT_EQ(result.soup[1][1], Vec3(3, 5, 0));
}

TEST(GltfInstances, FaultsAreNamed) {
    GltfBuilder builder = instanced({0, 0, 0, 0, 5, 0});
    instance_attributes(builder)["SCALE"] = builder.add_accessor<float>("VEC3", {1, 1, 1});
    expect_refused(builder, "node 0: the attributes of its instances differ in number");
    instance_attributes(builder) = {{"TRANSLATION", 99}};
    expect_refused(builder, "node 0: TRANSLATION: index 99 is not below 4");
    instance_attributes(builder) = {{"TRANSLATION", "x"}};
    expect_refused(builder, "node 0: TRANSLATION is not a whole number");
    instance_attributes(builder) = Json::object();
    expect_refused(builder, "its instances have no TRANSLATION, ROTATION or SCALE");
    builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = 3;
    expect_refused(builder, "node 0: EXT_mesh_gpu_instancing is not a JSON object");
}

TEST(GltfInstances, AFewBytesCannotAskForAllMemory) {
    GltfBuilder builder = instanced({0, 0, 0});
    builder.json["accessors"].push_back(
        {{"componentType", 5126}, {"count", 1 << 24}, {"type", "VEC3"}});
    instance_attributes(builder)["TRANSLATION"] = 3;
    expect_refused(builder, "it has 16777216 instances, more than 2^20");
}

// EXT_meshopt_compression.

using Bytes = std::vector<unsigned char>;

std::string text_of(const Bytes& bytes) {
    return {bytes.begin(), bytes.end()};
}

/// A bufferView whose bytes are compressed: `declared` of them when they are decoded.
int add_compressed_view(GltfBuilder& builder,
                        const Bytes& compressed,
                        std::size_t count,
                        std::size_t stride,
                        const std::string& mode,
                        const std::string& filter = "") {
    const int raw = builder.add_view(text_of(compressed));
    const Json& view = builder.json["bufferViews"][static_cast<std::size_t>(raw)];
    Json extension = {{"buffer", 0},
                      {"byteOffset", view["byteOffset"]},
                      {"byteLength", compressed.size()},
                      {"byteStride", stride},
                      {"count", count},
                      {"mode", mode}};
    if (!filter.empty()) {
        extension["filter"] = filter;
    }
    builder.json["bufferViews"].push_back(
        {{"buffer", 1},
         {"byteLength", count * stride},
         {"extensions", {{"EXT_meshopt_compression", extension}}}});
    if (mode == "ATTRIBUTES") {
        builder.json["bufferViews"].back()["byteStride"] = stride;
    }
    return static_cast<int>(builder.json["bufferViews"].size()) - 1;
}

/// A mesh whose positions and indices lie in those views; the fallback buffer has no bytes.
std::string compressed_mesh(GltfBuilder& builder, int positions, int indices, const Grid& grid) {
    builder.json["accessors"] = {{{"bufferView", positions},
                                  {"componentType", 5126},
                                  {"count", grid.positions.size() / 3},
                                  {"type", "VEC3"}},
                                 {{"bufferView", indices},
                                  {"componentType", 5125},
                                  {"count", grid.indices.size()},
                                  {"type", "SCALAR"}}};
    builder.add_node({{"mesh", builder.add_mesh(0, 1)}});
    builder.json["buffers"] = {
        {{"byteLength", builder.bytes.size()}},
        {{"byteLength", 1000000},
         {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    builder.json["extensionsUsed"] = {"EXT_meshopt_compression"};
    builder.json["extensionsRequired"] = {"EXT_meshopt_compression"};
    return builder.glb();
}

Bytes encoded_vertices(const void* vertices, std::size_t count, std::size_t stride) {
    Bytes bytes(meshopt_encodeVertexBufferBound(count, stride));
    bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), vertices, count, stride));
    return bytes;
}

Bytes encoded_triangles(const Grid& grid) {
    Bytes bytes(meshopt_encodeIndexBufferBound(grid.indices.size(), grid.positions.size() / 3));
    bytes.resize(meshopt_encodeIndexBuffer(
        bytes.data(), bytes.size(), grid.indices.data(), grid.indices.size()));
    return bytes;
}

struct MeshoptFile {
    Grid grid{20};
    GltfBuilder builder;
    int positions =
        add_compressed_view(builder,
                            encoded_vertices(grid.positions.data(), grid.positions.size() / 3, 12),
                            grid.positions.size() / 3,
                            12,
                            "ATTRIBUTES");
    int indices =
        add_compressed_view(builder, encoded_triangles(grid), grid.indices.size(), 4, "TRIANGLES");

    Json& extension(int view) {
        return builder.json["bufferViews"][static_cast<std::size_t>(view)]["extensions"]
                           ["EXT_meshopt_compression"];
    }
};

TEST(GltfMeshopt, AttributesAndTrianglesAreDecoded) {
    MeshoptFile file;
    const ReadSoup result =
        read(compressed_mesh(file.builder, file.positions, file.indices, file.grid));
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.warnings, "");
    EXPECT_EQ(result.soup.size(), 800U);
    EXPECT_EQ(canonical(result.soup), canonical(file.grid.soup()));
}

TEST(GltfMeshopt, IndexSequencesAreDecoded) {
    MeshoptFile file;
    const Grid& grid = file.grid;
    Bytes bytes(meshopt_encodeIndexSequenceBound(grid.indices.size(), grid.positions.size() / 3));
    bytes.resize(meshopt_encodeIndexSequence(
        bytes.data(), bytes.size(), grid.indices.data(), grid.indices.size()));
    const int indices = add_compressed_view(file.builder, bytes, grid.indices.size(), 4, "INDICES");
    const ReadSoup result = read(compressed_mesh(file.builder, file.positions, indices, grid));
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.soup, grid.soup());  // a sequence keeps its order
}

TEST(GltfMeshopt, ExponentialFiltersAreUndone) {
    MeshoptFile file;
    const Grid& grid = file.grid;
    const std::size_t count = grid.positions.size() / 3;
    std::vector<std::uint32_t> filtered(grid.positions.size());
    meshopt_encodeFilterExp(filtered.data(), count, 12, 15, grid.positions.data());
    const int positions = add_compressed_view(file.builder,
                                              encoded_vertices(filtered.data(), count, 12),
                                              count,
                                              12,
                                              "ATTRIBUTES",
                                              "EXPONENTIAL");
    const ReadSoup result = read(compressed_mesh(file.builder, positions, file.indices, grid));
    ASSERT_EQ(result.error, "");
    const Soup want = canonical(grid.soup());
    ASSERT_EQ(result.soup.size(), want.size());
    // Mantissas of 15 bits of numbers up to 5, one exponent to a vertex.
    for (const auto& triangle : result.soup) {
        for (const Vec3& p : triangle) {
            const bool is_known = std::any_of(want.begin(), want.end(), [&](const auto& t) {
                return std::any_of(t.begin(), t.end(), [&](const Vec3& q) {
                    return glm::dot(p - q, p - q) < 3.0 * (5.0 / 16384) * (5.0 / 16384);
                });
            });
            EXPECT_TRUE(is_known);
        }
    }
}

TEST(GltfMeshopt, FaultsAreNamed) {
    const std::vector<std::pair<std::string, std::function<void(MeshoptFile&)>>> faults = {
        {"its mode is LINES", [](auto& f) { f.extension(f.positions)["mode"] = "LINES"; }},
        {"mode is not a text", [](auto& f) { f.extension(f.positions)["mode"] = 3; }},
        {"byteStride 10 does not go", [](auto& f) { f.extension(f.positions)["byteStride"] = 10; }},
        {"byteStride 12 does not go", [](auto& f) { f.extension(f.indices)["byteStride"] = 12; }},
        {"byteStride is missing", [](auto& f) { f.extension(f.positions).erase("byteStride"); }},
        {"count is not a whole number", [](auto& f) { f.extension(f.positions)["count"] = -1; }},
        {"are not its byteLength", [](auto& f) { f.extension(f.positions)["count"] = 442; }},
        {"compressed bytes do not lie in buffer 0",
         [](auto& f) { f.extension(f.positions)["byteOffset"] = 1 << 30; }},
        {"its compressed buffer 9 does not exist",
         [](auto& f) { f.extension(f.positions)["buffer"] = 9; }},
        {"its filter QUATERNION does not go",
         [](auto& f) { f.extension(f.positions)["filter"] = "QUATERNION"; }},
        {"its compressed data is damaged",
         [](auto& f) {
             const auto offset = f.extension(f.positions)["byteOffset"].template get<std::size_t>();
             f.builder.bytes[offset] = 'x';
         }},
        {"compressed bytes cannot hold 1073741820",
         [](auto& f) {
             f.extension(f.positions)["count"] = 89478485;
             f.builder.json["bufferViews"][static_cast<std::size_t>(f.positions)]["byteLength"] =
                 1073741820;
         }},
    };
    for (const auto& [part, make] : faults) {
        MeshoptFile file;
        compressed_mesh(file.builder, file.positions, file.indices, file.grid);
        make(file);
        expect_refused(file.builder, part);
    }
}

// KHR_draco_mesh_compression.

std::string draco_bytes(const Grid& grid, bool is_sequential) {
    draco::TriangleSoupMeshBuilder soup;
    soup.Start(static_cast<int>(grid.indices.size() / 3));
    const int position =
        soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (std::size_t i = 0; i < grid.indices.size(); i += 3) {
        soup.SetAttributeValuesForFace(position,
                                       draco::FaceIndex(static_cast<std::uint32_t>(i / 3)),
                                       &grid.positions[3 * grid.indices[i]],
                                       &grid.positions[3 * grid.indices[i + 1]],
                                       &grid.positions[3 * grid.indices[i + 2]]);
    }
    const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(is_sequential ? draco::MESH_SEQUENTIAL_ENCODING
                                            : draco::MESH_EDGEBREAKER_ENCODING);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

/// Accessors without bufferViews, and the primitive's data as one view of Draco.
GltfBuilder draco_file(const std::string& bytes, const Grid& grid) {
    GltfBuilder builder;
    const int view = builder.add_view(bytes);
    builder.json["accessors"] = {
        {{"componentType", 5126}, {"count", grid.positions.size() / 3}, {"type", "VEC3"}},
        {{"componentType", 5123}, {"count", grid.indices.size()}, {"type", "SCALAR"}}};
    builder.add_node({{"mesh", builder.add_mesh(0, 1)}});
    builder.primitive(0)["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
    builder.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    builder.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return builder;
}

TEST(GltfDraco, MeshesAreDecoded) {
    for (const bool is_sequential : {false, true}) {
        for (const std::uint32_t size : {1U, 7U, 40U}) {
            const Grid grid(size);
            const ReadSoup result = read(draco_file(draco_bytes(grid, is_sequential), grid).glb());
            ASSERT_EQ(result.error, "");
            EXPECT_EQ(result.warnings, "");
            EXPECT_EQ(canonical(result.soup), canonical(grid.soup())) << size;
        }
    }
}

TEST(GltfDraco, FaultsAreNamed) {
    const Grid grid(7);
    const std::string good = draco_bytes(grid, false);
    GltfBuilder builder = draco_file(good, grid);
    builder.json["accessors"][0]["count"] = 63;
    expect_refused(builder, "Draco holds 64 vertices where 63 are declared");
    builder = draco_file(good, grid);
    builder.json["accessors"][1]["count"] = 300;
    expect_refused(builder, "Draco holds 98 triangles where 300 indices are declared");
    builder = draco_file(good, grid);
    Json& extension = builder.primitive(0)["extensions"]["KHR_draco_mesh_compression"];
    extension["attributes"] = {{"POSITION", 5}};
    expect_refused(builder, "Draco has no attribute 5 for POSITION");
    extension["attributes"] = {{"NORMAL", 0}};
    expect_refused(builder, "its Draco data has no POSITION");
    extension["bufferView"] = 7;
    expect_refused(builder, "its Draco bufferView 7 does not exist");
    expect_refused(draco_file("not Draco at all", grid), "its Draco data is not a mesh");
    expect_refused(draco_file(good.substr(0, good.size() / 2), grid), "its Draco data is damaged");
    builder = draco_file(good, grid);
    builder.primitive(0)["mode"] = 5;
    expect_refused(builder, "Draco compresses indexed triangles");
}

TEST(GltfDraco, AHeaderCannotAskForAllMemory) {
    // DRACO, version 2.2, a mesh by edgebreaker, no flags, standard traversal, then as variable
    // length numbers 2^28 vertices and 2^28 triangles.
    const std::string header("DRACO\2\2\1\1\0\0\0", 12);
    const std::string count = "\x80\x80\x80\x80\x01";
    const Grid grid(1);
    GltfBuilder builder = draco_file(header + count + count, grid);
    builder.json["accessors"][1]["count"] = 3ULL << 28U;
    expect_refused(builder, "22 bytes of Draco cannot hold 268435456 triangles");
}

TEST(GltfDraco, DamagedDataNeverCrashes) {
    const Grid grid(5);
    for (const bool is_sequential : {false, true}) {
        const std::string good = draco_bytes(grid, is_sequential);
        for (std::size_t at = 11; at < good.size(); ++at) {
            std::string damaged = good;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
            read(draco_file(damaged, grid).glb());  // may well load
        }
    }
}

// Others.

TEST(GltfExtensions, ThatMayChangeGeometryAreNamed) {
    GltfBuilder builder = test::one_triangle();
    builder.json["extensionsUsed"] = {"CESIUM_RTC", "KHR_materials_unlit", "EXT_texture_webp"};
    const ReadSoup used = read(builder.glb());
    EXPECT_EQ(used.error, "");
    EXPECT_NE(used.warnings.find("uses the extension CESIUM_RTC"), std::string::npos);
    EXPECT_EQ(std::count(used.warnings.begin(), used.warnings.end(), '\n'), 1) << used.warnings;
    builder.json["extensionsRequired"] = {"CESIUM_RTC"};
    expect_refused(builder, "requires the extension CESIUM_RTC, which earshot does not read");
}

TEST(GltfNumbers, MayBeWrittenWithAPoint) {
    GltfBuilder builder = test::one_triangle();
    builder.json["accessors"][0]["count"] = 3.0;
    builder.json["accessors"][0]["componentType"] = 5126.0;
    builder.json["bufferViews"][0]["byteOffset"] = 0.0;
    builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 0.0;
    builder.json["meshes"][0]["primitives"][0]["mode"] = 4.0;
    builder.json["scene"] = 0.0;
    builder.json["scenes"] = {{{"nodes", {0.0}}}};
    builder.json["nodes"][0]["translation"] = {1.0, -0.0, 2.5};
    const ReadSoup result = read(builder.glb());
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.soup[0][1], Vec3(2.0, 0.0, 2.5));
}

TEST(GltfIndices, WithoutAViewAreZeroButForSparseOnes) {
    GltfBuilder builder = test::one_triangle();
    const int where = builder.add_view(GltfBuilder::packed<std::uint8_t>({1, 2}));
    const int values = builder.add_view(GltfBuilder::packed<std::uint16_t>({1, 2}));
    builder.json["accessors"][1] = {{"componentType", 5123},
                                    {"count", 6},
                                    {"type", "SCALAR"},
                                    {"sparse",
                                     {{"count", 2},
                                      {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}}}};
    const ReadSoup result = read(builder.glb());
    ASSERT_EQ(result.error, "");
    ASSERT_EQ(result.soup.size(), 2U);
    EXPECT_EQ(result.soup[0][1], Vec3(1, 0, 0));
    EXPECT_EQ(result.soup[1][0], result.soup[1][2]);  // 0, 0, 0: without area, but there
}

TEST(GltfVertices, ThatNoTriangleUsesMayHoldAnything) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    GltfBuilder builder = test::one_triangle();
    builder.primitive(0)["attributes"]["POSITION"] = builder.add_accessor<float>(
        "VEC3", {0, 0, 0, nan, 0, 0, 1, 0, 0, 0, 1, 0, 0, infinity, -infinity});
    builder.primitive(0)["indices"] = builder.add_accessor<std::uint16_t>("SCALAR", {0, 2, 3});
    const ReadSoup result = read(builder.glb());
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.soup, (Soup{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}}));
    builder.primitive(0)["indices"] = builder.add_accessor<std::uint16_t>("SCALAR", {0, 2, 4});
    expect_refused(builder, "accessor 2: element 4 is not a finite number");
}

TEST(GltfIndices, ThatAreNoWholeTrianglesAreLeftOut) {
    for (const std::size_t surplus : {1U, 2U}) {
        GltfBuilder builder = test::one_triangle();
        std::vector<std::uint16_t> indices = {0, 1, 2, 2, 1};
        indices.resize(3 + surplus);
        const int accessor = builder.add_accessor("SCALAR", indices);
        builder.primitive(0)["indices"] = accessor;
        const ReadSoup result = read(builder.glb());
        EXPECT_EQ(result.soup.size(), 1U) << result.error;
        EXPECT_NE(result.warnings.find("mesh 0 primitive 0: " + std::to_string(3 + surplus) +
                                       " indices are not whole triangles; the last " +
                                       std::to_string(surplus) + " are left out"),
                  std::string::npos)
            << result.warnings;
    }
}

}  // namespace
}  // namespace earshot::io
