// SPDX-License-Identifier: MIT
// Files that ask for much more than their size: what mutations of small seeds do not reach. Each
// takes a reader seconds at most and stays within the bound of memory.
#include "earshot/base/math.h"

#include <gtest/gtest.h>

#include "fuzz/limits.h"
#include "fuzz/readers.h"
#include "support/gltf_builder.h"
#include <cmath>
#include <cstdio>
#include <functional>

namespace earshot::test {
namespace {

using Json = GltfBuilder::Json;

struct LargeInput {
    std::string name;
    std::string reader;
    Outcome outcome;
    std::function<std::string()> make;
};

void PrintTo(const LargeInput& input, std::ostream* stream) {
    *stream << input.name;
}

std::string repeated(const std::string& text, std::size_t times) {
    std::string whole;
    for (std::size_t i = 0; i < times; ++i) {
        whole += text;
    }
    return whole;
}

std::string nested(std::size_t levels) {
    return std::string(levels, '[') + std::string(levels, ']');
}

std::string nested_extras() {
    GltfBuilder b = one_triangle();
    b.primitive(0)["material"] = 0;
    b.json["materials"] = {{{"extras", {{"acoustics", "{\"library\":" + nested(200000) + "}"}}}}};
    return b.gltf();
}

std::string long_names() {
    GltfBuilder b = one_triangle();
    b.primitive(0)["material"] = 0;
    const std::string name(std::size_t{1} << 25U, 'a');
    b.json["materials"] = {{{"extras", {{name, 1}, {"acoustics", name}}}}};
    return b.glb();
}

/// A polygon of 999 corners around its last one, in steps of almost half a turn: every corner is
/// convex, and only the last corner says that it is no ear.
std::string star_polygons() {
    constexpr int kCorners = 999;
    std::string obj;
    std::string face = "f";
    for (int i = 0; i < kCorners; ++i) {
        const double angle = 2.0 * math::kPi * (i * 499 % kCorners) / kCorners;
        obj +=
            "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    return obj + "v 0 0 0\n" + repeated(face + " 1000\n", 40);
}

std::string solids_on_one_line() {
    return repeated(
        "solid a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
        "endloop endfacet endsolid a ",
        30000);
}

std::string words_before_blanks() {
    return "solid\n" +
           repeated(
               "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop "
               "endfacet ",
               10000) +
           "endsolid" + std::string(1000000, ' ');
}

std::string elements_with_surplus() {
    std::string header = "ply\nformat ascii 1.0\n";
    for (int i = 0; i < 60000; ++i) {
        header += "element e" + std::to_string(i) + " 1\nproperty char a\n";
    }
    return header +
           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
           "1\nproperty list uchar int vertex_indices\nend_header\n" +
           repeated("1 2\n", 60000) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
}

/// Zeros without bytes.
int add_zeros(GltfBuilder& b, const std::string& type, std::size_t count) {
    b.json["accessors"].push_back({{"componentType", 5126}, {"count", count}, {"type", type}});
    return static_cast<int>(b.json["accessors"].size()) - 1;
}

constexpr std::size_t kManyPoints = 5000000;

/// A mesh of many points under many nodes.
std::string reused_mesh() {
    GltfBuilder b;
    const int mesh = b.add_mesh(add_zeros(b, "VEC3", kManyPoints));
    for (int i = 0; i < 1000; ++i) {
        b.add_node({{"mesh", mesh}});
    }
    return b.glb();
}

/// Many primitives that each use one of many points.
std::string reused_points() {
    GltfBuilder b = one_triangle();
    const Json primitive = {{"attributes", {{"POSITION", add_zeros(b, "VEC3", kManyPoints)}}},
                            {"indices", 1}};
    for (int i = 0; i < 10000; ++i) {
        b.json["meshes"][0]["primitives"].push_back(primitive);
    }
    return b.glb();
}

std::string many_targets() {
    GltfBuilder b;
    const int points = add_zeros(b, "VEC3", kManyPoints);
    b.add_node({{"mesh", b.add_mesh(points)}});
    for (int i = 0; i < 1000; ++i) {
        b.primitive(0)["targets"].push_back({{"POSITION", points}});
    }
    return b.glb();
}

std::string many_influences() {
    GltfBuilder b;
    b.add_node({{"mesh", b.add_mesh(add_zeros(b, "VEC3", 4000000))}, {"skin", 0}});
    b.json["skins"] = {{{"joints", {0}}}};
    const int zeros = add_zeros(b, "VEC4", 4000000);
    b.json["accessors"].push_back({{"componentType", 5121}, {"count", 4000000}, {"type", "VEC4"}});
    for (int i = 0; i < 1000; ++i) {
        b.primitive(0)["attributes"]["JOINTS_" + std::to_string(i)] = zeros + 1;
        b.primitive(0)["attributes"]["WEIGHTS_" + std::to_string(i)] = zeros;
    }
    return b.glb();
}

std::string many_matrices() {
    GltfBuilder b = one_triangle();
    b.primitive(0)["attributes"]["JOINTS_0"] =
        b.add_accessor("VEC4", std::vector<std::uint8_t>(12, 0));
    b.primitive(0)["attributes"]["WEIGHTS_0"] = b.add_accessor("VEC4", std::vector<float>(12, 1));
    b.json["skins"] = {
        {{"joints", {0}}, {"inverseBindMatrices", add_zeros(b, "MAT4", std::size_t{1} << 24U)}}};
    b.json["nodes"][0]["skin"] = 0;
    return b.glb();
}

std::string many_instances() {
    GltfBuilder b = one_triangle();
    const int places = add_zeros(b, "VEC3", std::size_t{1} << 19U);
    b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", places}};
    for (int i = 0; i < 100; ++i) {
        b.add_node(b.json["nodes"][0]);
    }
    return b.glb();
}

/// The chain of nodes is as long as the file says, whatever follows it by recursion.
std::string chain_of_nodes() {
    GltfBuilder b = one_triangle();
    for (int i = 0; i < 100000; ++i) {
        b.add_node({{"children", {i}}});
    }
    return b.glb();
}

std::vector<LargeInput> inputs() {
    constexpr Outcome kRead = Outcome::read, kRefused = Outcome::refused;
    return {
        {"NestedMaterials", "materials", kRefused, [] { return "{\"a\":" + nested(200000) + "}"; }},
        {"NestedExtras", "gltf", kRefused, nested_extras},
        {"LongNames", "glb", kRefused, long_names},
        {"StarPolygons", "obj", kRead, star_polygons},
        {"SolidsOnOneLine", "stl", kRead, solids_on_one_line},
        {"WordsBeforeBlanks", "stl", kRead, words_before_blanks},
        {"ElementsWithSurplus", "ply", kRead, elements_with_surplus},
        {"ReusedMesh", "glb", kRefused, reused_mesh},
        {"ReusedPoints", "glb", kRefused, reused_points},
        {"ManyTargets", "glb", kRefused, many_targets},
        {"ManyInfluences", "glb", kRefused, many_influences},
        {"ManyMatrices", "glb", kRefused, many_matrices},
        {"ManyInstances", "glb", kRefused, many_instances},
        {"ChainOfNodes", "glb", kRead, chain_of_nodes},
    };
}

class LargeInputs : public testing::TestWithParam<LargeInput> {};

TEST_P(LargeInputs, StayWithinBounds) {
    const std::string bytes = GetParam().make();
    limit_memory();
    restart_time_limit();
    const double begin = processor_seconds();
    EXPECT_EQ(fuzz_one(reader_named(GetParam().reader), bytes), GetParam().outcome);
    std::printf("%s: %zu bytes, %.2f s\n",
                GetParam().name.c_str(),
                bytes.size(),
                processor_seconds() - begin);
}

INSTANTIATE_TEST_SUITE_P(Readers, LargeInputs, testing::ValuesIn(inputs()), [](const auto& test) {
    return test.param.name;
});

}  // namespace
}  // namespace earshot::test
