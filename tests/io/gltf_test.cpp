// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/gltf_builder.h"
#include "support/temporary_folder.h"
#include <cmath>

namespace earshot::io {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using test::GltfBuilder;
using test::one_triangle;
using Json = nlohmann::json;

LoadedScene load(const GltfBuilder& builder, const SceneOptions& options = {}) {
    const test::TemporaryFolder folder;
    return load_scene(folder.file("scene.glb", builder.glb()), options);
}

std::vector<Vec3> positions_of(const GltfBuilder& builder, double t = 0.0) {
    return load(builder).scene.mesh.positions_at(t);
}

const std::vector<Vec3> kPlain{{0.1F, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.3F}};

TEST(Gltf, KeepsPositionsToTheLastBit) {
    const LoadedScene loaded = load(one_triangle());
    EXPECT_EQ(loaded.scene.mesh.positions_at(0.0), kPlain);
    EXPECT_EQ(loaded.scene.mesh.triangles(), (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(loaded.scene.name, "scene.glb");
    EXPECT_EQ(loaded.scene.mesh.duration(), 0.0);
}

TEST(Gltf, ReadsDataUrisAndFilesBeside) {
    const test::TemporaryFolder folder;
    const GltfBuilder builder = one_triangle();
    const auto embedded = folder.file("a.gltf", builder.gltf());
    EXPECT_EQ(load_scene(embedded).scene.mesh.positions_at(0.0), kPlain);
    folder.file("my buffer.bin", builder.bytes + "longer than claimed");
    const auto beside = folder.file("B.GLTF", builder.gltf("my%20buffer.bin"));
    EXPECT_EQ(load_scene(beside).scene.mesh.positions_at(0.0), kPlain);
}

TEST(Gltf, DoesNotAskForImages) {
    GltfBuilder builder = one_triangle();
    builder.json["images"] = {{{"uri", "absent.png"}},
                              {{"uri", "data:image/png;base64,!!!"}},
                              {{"bufferView", 99}, {"mimeType", "image/png"}}};
    builder.json["textures"] = {{{"source", 0}}};
    builder.json["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    EXPECT_EQ(positions_of(builder), kPlain);
}

TEST(Gltf, ReadsIndicesOfEveryWidthAndNone) {
    for (const int width : {0, 1, 2, 4}) {
        GltfBuilder builder = one_triangle();
        builder.primitive(0).erase("indices");
        if (width == 1) {
            builder.primitive(0)["indices"] =
                builder.add_accessor<std::uint8_t>("SCALAR", {2, 0, 1});
        } else if (width == 2) {
            builder.primitive(0)["indices"] =
                builder.add_accessor<std::uint16_t>("SCALAR", {2, 0, 1});
        } else if (width == 4) {
            builder.primitive(0)["indices"] =
                builder.add_accessor<std::uint32_t>("SCALAR", {2, 0, 1});
        }
        const Triangle want = width == 0 ? Triangle{0, 1, 2} : Triangle{2, 0, 1};
        EXPECT_EQ(load(builder).scene.mesh.triangles()[0], want) << width << " bytes";
    }
}

TEST(Gltf, StripsAndFansKeepTheirWinding) {
    GltfBuilder builder = one_triangle();
    builder.primitive(0)["attributes"]["POSITION"] =
        builder.add_accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    builder.primitive(0).erase("indices");
    builder.primitive(0)["mode"] = 5;
    EXPECT_EQ(load(builder).scene.mesh.triangles(),
              (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
    builder.primitive(0)["mode"] = 6;
    EXPECT_EQ(load(builder).scene.mesh.triangles(),
              (std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
}

TEST(Gltf, PointsAndLinesAreLeftOutWithAWarning) {
    GltfBuilder builder = one_triangle();
    Json lines = builder.primitive(0);
    lines["mode"] = 1;
    builder.json["meshes"][0]["primitives"].push_back(lines);
    const LoadedScene loaded = load(builder);
    EXPECT_EQ(loaded.scene.mesh.triangles().size(), 1U);
    ASSERT_FALSE(loaded.warnings.empty());
    EXPECT_EQ(loaded.warnings[0].what, "mesh 0 primitive 1: points and lines are left out");
}

TEST(Gltf, StridesOffsetsAndNormalizedIntegers) {
    // Three vertices of four signed shorts, the fourth being padding, after two bytes of nothing.
    GltfBuilder builder = one_triangle();
    const int view =
        builder.add_view("xx" + GltfBuilder::packed<std::int16_t>(
                                    {32767, 0, 0, 9, 0, -32767, 0, 9, 16384, 0, -32768, 9}));
    builder.json["bufferViews"][static_cast<std::size_t>(view)]["byteStride"] = 8;
    Json& accessor = builder.json["accessors"][0];
    accessor["bufferView"] = view;
    accessor["byteOffset"] = 2;
    accessor["componentType"] = 5122;
    accessor["normalized"] = true;
    builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    EXPECT_EQ(
        positions_of(builder),
        (std::vector<Vec3>{{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {16384.0 / 32767.0, 0.0, -1.0}}));
    accessor["normalized"] = false;
    EXPECT_EQ(positions_of(builder)[2], Vec3(16384.0, 0.0, -32768.0));
}

TEST(Gltf, SparseValuesReplaceSomeElements) {
    GltfBuilder builder = one_triangle();
    const int which = builder.add_view(GltfBuilder::packed<std::uint8_t>({1}));
    const int values = builder.add_view(GltfBuilder::packed<float>({7.0F, 8.0F, 9.0F}));
    builder.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", which}, {"componentType", 5121}}},
        {"values", {{"bufferView", values}}}};
    EXPECT_EQ(positions_of(builder), (std::vector<Vec3>{kPlain[0], {7.0, 8.0, 9.0}, kPlain[2]}));
    builder.json["accessors"][0].erase("bufferView");  // zeros but for the sparse ones
    EXPECT_EQ(positions_of(builder), (std::vector<Vec3>{Vec3(0.0), {7.0, 8.0, 9.0}, Vec3(0.0)}));
}

TEST(Gltf, OneMeshUnderSeveralNodes) {
    GltfBuilder builder = one_triangle();
    builder.add_node({{"mesh", 0}, {"translation", {10, 0, 0}}});
    builder.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
    const LoadedScene loaded = load(builder);
    EXPECT_EQ(loaded.scene.mesh.positions_at(0.0)[4], Vec3(11.0, 0.0, 0.0));
    EXPECT_EQ(loaded.scene.mesh.positions_at(0.0)[7], Vec3(-1.0, 0.0, 0.0));
    EXPECT_EQ(loaded.scene.mesh.triangles(),
              (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}, {6, 8, 7}}));
}

TEST(Gltf, VerticesThatNoTriangleUsesAreLeftOut) {
    GltfBuilder builder = one_triangle();
    builder.primitive(0)["attributes"]["POSITION"] =
        builder.add_accessor<float>("VEC3", {9, 9, 9, 0, 0, 0, 1, 0, 0, 9, 9, 9, 0, 1, 0});
    builder.primitive(0)["indices"] = builder.add_accessor<std::uint16_t>("SCALAR", {4, 1, 2});
    EXPECT_EQ(positions_of(builder), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(load(builder).scene.mesh.triangles()[0], (Triangle{2, 0, 1}));
}

TEST(Gltf, ParentsMayStandAfterTheirChildren) {
    GltfBuilder builder = one_triangle();  // node 0
    builder.add_node({{"translation", {0, 0, 1}}, {"children", {0}}});
    builder.add_node({{"scale", {2, 2, 2}}, {"children", {1}}});
    EXPECT_EQ(positions_of(builder)[1], Vec3(2.0, 0.0, 2.0));
}

TEST(Gltf, MatrixNodesMoveTheirMesh) {
    GltfBuilder builder = one_triangle();
    builder.json["nodes"][0]["matrix"] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
    EXPECT_EQ(positions_of(builder)[1], Vec3(5.0, 7.0, 7.0));
}

TEST(Gltf, OnlyTheDefaultSceneIsRead) {
    GltfBuilder builder = one_triangle();
    builder.add_node({{"mesh", 0}, {"translation", {0, 0, 5}}});
    builder.add_node({{"mesh", 0}, {"translation", {0, 0, 6}}});
    EXPECT_EQ(positions_of(builder).size(), 9U);
    builder.json["scenes"] = {{{"nodes", {1}}}, {{"nodes", {2, 0}}}};
    EXPECT_EQ(positions_of(builder)[0].z, 5.0);
    builder.json["scene"] = 1;
    EXPECT_EQ(positions_of(builder).size(), 6U);
    EXPECT_EQ(positions_of(builder)[3].z, 6.0);
}

TEST(Gltf, AnimationMovesNodesAndIsChosenByNameOrIndex) {
    GltfBuilder builder = one_triangle();
    const int times = builder.add_accessor<float>("SCALAR", {0.0F, 2.0F});
    const int slide = builder.add_accessor<float>("VEC3", {0, 0, 0, 4, 0, 0});
    const int grow = builder.add_accessor<float>("VEC3", {1, 1, 1, 3, 3, 3});
    builder.add_animation(0, "translation", times, slide, "LINEAR");
    builder.add_animation(0, "scale", times, grow, "STEP");
    builder.json["animations"][1]["name"] = "grow";
    EXPECT_EQ(load(builder).scene.mesh.duration(), 2.0);
    EXPECT_EQ(positions_of(builder, 1.0)[1], Vec3(3.0, 0.0, 0.0));
    for (const char* wanted : {"grow", "1"}) {
        const LoadedScene loaded = load(builder, {.animation = wanted});
        EXPECT_EQ(loaded.scene.mesh.positions_at(1.9)[1], Vec3(1.0, 0.0, 0.0));
        EXPECT_EQ(loaded.scene.mesh.positions_at(2.0)[1], Vec3(3.0, 0.0, 0.0));
    }
    EXPECT_THROW(load(builder, {.animation = "shrink"}), Error);
    EXPECT_THROW(load(builder, {.animation = "2"}), Error);
}

TEST(Gltf, AnimatedMatrixIsTakenApart) {
    GltfBuilder builder = one_triangle();
    // Mirrored in x, doubled in z, turned by 90 degrees about z, moved.
    builder.json["nodes"][0]["matrix"] = {0, -1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1};
    const std::vector<Vec3> want = positions_of(builder);
    const int times = builder.add_accessor<float>("SCALAR", {0.0F});
    builder.add_animation(
        0, "translation", times, builder.add_accessor<float>("VEC3", {5, 6, 7}), "STEP");
    const std::vector<Vec3> got = positions_of(builder);
    for (std::size_t i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(got[i][axis], want[i][axis], 1e-14);  // a few roundings of numbers near 8
        }
    }
}

TEST(Gltf, NormalizedRotationKeys) {
    GltfBuilder builder = one_triangle();
    const int times = builder.add_accessor<float>("SCALAR", {0.0F});
    const int half_turn = builder.add_accessor<std::int8_t>("VEC4", {0, 0, 127, 0}, true);
    builder.add_animation(0, "rotation", times, half_turn, "LINEAR");
    EXPECT_EQ(positions_of(builder)[1], Vec3(-1.0, 0.0, 0.0));
}

TEST(Gltf, SkinsUseAllInfluenceSets) {
    GltfBuilder builder = one_triangle();
    builder.add_node({{"translation", {0, 0, 8}}});
    builder.json["skins"] = {{{"joints", {1, 0}}}};
    builder.json["nodes"][0]["skin"] = 0;
    builder.json["nodes"][0]["translation"] = {0, 4, 0};
    Json& attributes = builder.primitive(0)["attributes"];
    const std::vector<std::uint8_t> first_joint(12, 0);
    const std::vector<std::uint16_t> second_joint(12, 1);
    attributes["JOINTS_0"] = builder.add_accessor("VEC4", first_joint);
    attributes["WEIGHTS_0"] =
        builder.add_accessor<std::uint8_t>("VEC4", {255, 0, 0, 0, 0, 0, 0, 0, 51, 51, 51, 0}, true);
    attributes["JOINTS_1"] = builder.add_accessor("VEC4", second_joint);
    attributes["WEIGHTS_1"] =
        builder.add_accessor<float>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0.1F, 0.1F, 0.1F, 0.1F});
    const std::vector<Vec3> got = positions_of(builder);
    EXPECT_EQ(got[0], kPlain[0] + Vec3(0.0, 0.0, 8.0));
    EXPECT_EQ(got[1], kPlain[1] + Vec3(0.0, 4.0, 0.0));
    EXPECT_NEAR(got[2].y, 1.0 + 0.4 * 4.0, 1e-6);  // weights stored as floats
    EXPECT_NEAR(got[2].z, double{0.3F} + 0.6 * 8.0, 1e-6);
}

TEST(Gltf, MorphTargetsTakeWeightsFromNodeMeshOrAnimation) {
    GltfBuilder builder = one_triangle();
    const int up = builder.add_accessor<float>("VEC3", {0, 0, 0, 0, 2, 0, 0, 0, 0});
    builder.primitive(0)["targets"] = {{{"POSITION", up}}, Json::object()};
    EXPECT_EQ(positions_of(builder)[1], kPlain[1]);
    builder.json["meshes"][0]["weights"] = {0.5, 0.0};
    EXPECT_EQ(positions_of(builder)[1].y, 1.0);
    builder.json["nodes"][0]["weights"] = {0.25, 0.0};
    EXPECT_EQ(positions_of(builder)[1].y, 0.5);
    const int times = builder.add_accessor<float>("SCALAR", {0.0F, 1.0F});
    const int weights = builder.add_accessor<float>("SCALAR", {0, 0, 1, 0});
    builder.add_animation(0, "weights", times, weights, "LINEAR");
    EXPECT_EQ(positions_of(builder, 0.75)[1].y, 1.5);
}

TEST(Gltf, SourcesAndListenersRideOnTheirNodes) {
    GltfBuilder builder = one_triangle();
    builder.add_node(
        {{"name", "speaker"},
         {"translation", {1, 2, 3}},
         {"extras", {{"acoustics", {{"role", "source"}, {"directivity", "cardioid"}}}}}});
    builder.add_node({{"name", "ear"}, {"extras", {{"acoustics", {{"role", "listener"}}}}}});
    builder.add_node({{"name", "radio"},
                      {"translation", {0, 0, 9}},
                      {"extensions", {{"KHR_audio_emitter", {{"emitter", 0}}}}}});
    builder.json["extensions"] = {
        {"KHR_audio_emitter", {{"emitters", {{{"type", "positional"}}}}}}};
    builder.json["extensionsUsed"] = {"KHR_audio_emitter"};
    const int times = builder.add_accessor<float>("SCALAR", {0.0F, 1.0F});
    const int walk = builder.add_accessor<float>("VEC3", {0, 0, 0, 0, 2, 0});
    builder.add_animation(2, "translation", times, walk, "LINEAR");
    const propagation::Scene scene = load(builder).scene;
    ASSERT_EQ(scene.sources.size(), 2U);
    ASSERT_EQ(scene.listeners.size(), 1U);
    EXPECT_EQ(scene.sources[0].name, "speaker");
    EXPECT_NEAR(
        scene.sources[0].directivity.pressure(audio::Bands::octaves(), {-1, 0, 0})[0], 0.0, 1e-15);
    EXPECT_EQ(scene.sources[1].directivity.pressure(audio::Bands::octaves(), {-1, 0, 0})[0], 1.0);
    EXPECT_EQ(scene.position_at(scene.sources[0], 0.0), Vec3(1.0, 2.0, 3.0));
    EXPECT_EQ(scene.sources[1].name, "radio");
    EXPECT_EQ(scene.listeners[0].name, "ear");
    EXPECT_EQ(scene.position_at(scene.listeners[0], 0.5), Vec3(0.0, 1.0, 0.0));
}

}  // namespace
}  // namespace earshot::io
