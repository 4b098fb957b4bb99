// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include "triangle_soup.h"
#include <algorithm>
#include <array>
#include <cstring>
#include <iostream>
#include <utility>

namespace earshot::io {
namespace {

using geometry::Triangle;
using geometry::Vec3;

// A unit cube whose faces are counter-clockwise seen from outside.
constexpr std::array<std::array<int, 3>, 8> kCorners{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

template <typename T>
std::string raw(T value, bool is_reversed = false) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (is_reversed) {
        std::reverse(bytes.begin(), bytes.end());
    }
    return bytes;
}

std::string cube_obj() {
    std::string text = "# a cube\no cube\n";
    for (const auto& c : kCorners) {
        text += "v " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " +
                std::to_string(c[2]) + "\n";
    }
    for (const auto& f : kFaces) {
        text += "f";
        for (const int i : f) {
            text += " " + std::to_string(i + 1) + "/1/1";
        }
        text += "\r\n";
    }
    return text;
}

std::string cube_off() {
    std::string text = "OFF\n# a cube\n8 6 0\n\n";
    for (const auto& c : kCorners) {
        text +=
            std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) + "\n";
    }
    for (const auto& f : kFaces) {
        text += "4";
        for (const int i : f) {
            text += " " + std::to_string(i);
        }
        text += " 0.5 0.5 0.5 # grey\n";
    }
    return text;
}

std::string ply_header(const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty double y\n"
           "property uchar shine\nproperty short z\nelement face 6\nproperty uchar flags\n"
           "property list uchar int vertex_indices\nproperty list int float weights\n"
           "end_header\n";
}

std::string cube_ply(const std::string& format) {
    std::string text = ply_header(format);
    const bool is_text = format == "ascii";
    const bool is_big = format == "binary_big_endian";
    const auto put = [&](auto number) {
        text += is_text ? std::to_string(number) + " " : raw(number, is_big);
    };
    const auto put_byte = [&](int number) {
        text += is_text ? std::to_string(number) + " " : std::string(1, static_cast<char>(number));
    };
    for (const auto& c : kCorners) {
        put(static_cast<float>(c[0]));
        put(static_cast<double>(c[1]));
        put_byte(200);
        put(static_cast<std::int16_t>(c[2]));
    }
    for (const auto& f : kFaces) {
        put_byte(1);
        put_byte(4);
        for (const int i : f) {
            put(std::int32_t{i});
        }
        put(std::int32_t{1});
        put(0.5F);
    }
    return text;
}

std::string cube_stl(bool is_text) {
    std::string facets;
    for (const auto& f : kFaces) {
        // The diagonal that the other formats' quads are cut along.
        for (const std::array<int, 3>& t :
             {std::array<int, 3>{f[0], f[1], f[2]}, std::array<int, 3>{f[0], f[2], f[3]}}) {
            facets += is_text ? "facet normal 0 0 0\n outer loop\n" : std::string(12, '\0');
            for (const int i : t) {
                facets += is_text ? "  vertex" : "";
                for (const int x : kCorners[static_cast<std::size_t>(i)]) {
                    facets +=
                        is_text ? " " + std::to_string(x) + ".0e+0" : raw(static_cast<float>(x));
                }
                facets += is_text ? "\n" : "";
            }
            facets += is_text ? " endloop\nendfacet\n" : std::string(2, '\0');
        }
    }
    std::string comment = "solid but binary";
    comment.resize(80);
    return is_text ? "solid cube\n" + facets + "endsolid cube\n"
                   : comment + raw(std::uint32_t{12}) + facets;
}

TEST(MeshFiles, TheSameCubeInEveryFormatIsTheSameScene) {
    const test::TemporaryFolder folder;
    const std::vector<std::pair<std::string, std::string>> files{
        {"cube.OBJ", cube_obj()},
        {"cube.off", cube_off()},
        {"cube.Ply", cube_ply("ascii")},
        {"little.ply", cube_ply("binary_little_endian")},
        {"big.ply", cube_ply("binary_big_endian")},
        {"cube.stl", cube_stl(true)},
        {"binary.STL", cube_stl(false)},
    };
    Soup want;
    for (const auto& f : kFaces) {
        const auto corner = [&](int i) {
            const auto& c = kCorners[static_cast<std::size_t>(f[static_cast<std::size_t>(i)])];
            return Vec3(c[0], c[1], c[2]);
        };
        want.push_back({corner(0), corner(1), corner(2)});
        want.push_back({corner(0), corner(2), corner(3)});
    }
    for (const auto& [name, bytes] : files) {
        const LoadedScene loaded = load_scene(folder.file(name, bytes));
        EXPECT_EQ(canonical(soup_of(loaded.scene)), canonical(want)) << name;
        EXPECT_EQ(loaded.scene.material_of_triangle, std::vector<std::uint32_t>(12, 0)) << name;
        ASSERT_EQ(loaded.scene.materials.size(), 1U) << name;
        EXPECT_EQ(loaded.scene.materials[0].name, "default");
        EXPECT_EQ(loaded.scene.materials[0].absorption.at(500.0), 0.1) << name;
        EXPECT_EQ(loaded.scene.materials[0].scattering.at(500.0), 0.1) << name;
        EXPECT_TRUE(loaded.warnings.empty()) << name;
        EXPECT_EQ(loaded.default_materials, std::vector<std::uint32_t>{0}) << name;
        EXPECT_EQ(loaded.scene.name, name);
    }
}

TEST(MeshFiles, CoordinatesKeepDoublePrecision) {
    const test::TemporaryFolder folder;
    const std::string numbers = "0.1234567890123456 -1e-3 +7.25\n1 0 0\n0 1 0\n";
    const Vec3 want(0.1234567890123456, -1e-3, 7.25);
    const std::vector<std::filesystem::path> files{
        folder.file("a.off", "OFF 3 1 0\n" + numbers + "3 0 1 2\n"),
        folder.file("a.obj", "v 0.1234567890123456 -1e-3 +7.25\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        folder.file("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
                    "property double y\nproperty double z\nelement face 1\n"
                    "property list uchar uint vertex_index\nend_header\n" +
                        numbers + "3 0 1 2\n")};
    for (const auto& file : files) {
        EXPECT_EQ(load_scene(file).scene.mesh.positions_at(0.0)[0], want) << file;
    }
}

TEST(MeshFiles, EveryFaceOfANonManifoldMeshIsKept) {
    const test::TemporaryFolder folder;
    // Three triangles at one edge, one of them also the other way round, and one twice.
    const auto file = folder.file("fin.obj",
                                  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\n"
                                  "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 2 1 5\nf 1 2 3\n");
    EXPECT_EQ(load_scene(file).scene.mesh.triangles(),
              (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {1, 0, 4}, {0, 1, 2}}));
}

TEST(MeshFiles, UsemtlNamesLibraryMaterials) {
    const test::TemporaryFolder folder;
    const auto file = folder.file("walls.obj",
                                  "mtllib absent.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
                                  "usemtl brick-painted\nf 1 2 3\nusemtl my own\nf 1 2 4\n"
                                  "usemtl brick-painted\nf -4 -3 -1\n");
    const LoadedScene loaded = load_scene(file);
    ASSERT_EQ(loaded.scene.materials.size(), 2U);
    EXPECT_EQ(loaded.scene.materials[0].name, "brick-painted");
    EXPECT_EQ(loaded.scene.materials[0].absorption.at(500.0),
              propagation::find_library_material("brick-painted")->absorption.at(500.0));
    EXPECT_EQ(loaded.scene.materials[1].name, "my own");
    EXPECT_EQ(loaded.scene.material_of_triangle, (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_EQ(loaded.scene.mesh.triangles()[2], (Triangle{0, 1, 3}));
    EXPECT_TRUE(loaded.warnings.empty());
    const Warnings warnings = warnings_of_acoustics(loaded);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("my own"), std::string::npos);
}

TEST(MeshFiles, ObjLinesMayBeContinued) {
    const test::TemporaryFolder folder;
    const auto file = folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 \\\n 3\n");
    EXPECT_EQ(load_scene(file).scene.mesh.triangles(), (std::vector<Triangle>{{0, 1, 2}}));
}

std::filesystem::path shared_model(const char* name) {
    return test::shared_file("models") / name;
}

struct Model {
    const char* name;
    std::size_t triangles;
};

TEST(MeshFiles, RealModelsLoadWhole) {
    for (const Model& model : {Model{"cloth_ball92.ply", 92230},
                               Model{"stanford-bunny.obj", 69451},
                               Model{"armadillo.obj", 86482},
                               Model{"kitchen.ply", 1443509}}) {
        if (!std::filesystem::exists(shared_model(model.name))) {
            GTEST_SKIP() << "reference model " << model.name << " is not here";
        }
        const LoadedScene loaded = load_scene(shared_model(model.name));
        EXPECT_EQ(loaded.scene.mesh.triangles().size(), model.triangles) << model.name;
    }
}

TEST(MeshFiles, BigEndianClothHasItsFirstVertex) {
    const std::filesystem::path file = shared_model("cloth_ball92.ply");
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "reference model cloth_ball92.ply is not here";
    }
    const LoadedScene loaded = load_scene(file);
    EXPECT_EQ(loaded.scene.mesh.vertex_count(), 46598U);
    // The first twelve bytes after the header, read by hand.
    EXPECT_EQ(loaded.scene.mesh.positions_at(0.0)[0],
              Vec3(5.3881559371948242, 0.40000000596046448, -13.101426124572754));
    EXPECT_EQ(loaded.scene.mesh.triangles()[0], (Triangle{728, 729, 3488}));
}

}  // namespace
}  // namespace earshot::io
