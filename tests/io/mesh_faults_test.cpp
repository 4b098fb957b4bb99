// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <cstring>

namespace earshot::io {
namespace {

struct Fault {
    std::string name;  ///< of the file
    std::string bytes;
    std::string expected;  ///< must be part of the error line
};

std::string float_bytes(std::initializer_list<float> numbers) {
    std::string bytes;
    for (const float number : numbers) {
        char raw[4];
        std::memcpy(raw, &number, 4);
        bytes.append(raw, 4);
    }
    return bytes;
}

std::string stl_of(std::uint32_t claimed, const std::string& facets) {
    std::string bytes(80, 'x');
    bytes.resize(84);
    std::memcpy(bytes.data() + 80, &claimed, 4);
    return bytes + facets;
}

const std::string kFacet = float_bytes({0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0');

std::string ply(const std::string& counts_and_properties, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + counts_and_properties + "end_header\n" + body;
}

const std::string kThree =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kOneFace = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kPoints = "0 0 0\n1 0 0\n0 1 0\n";

std::vector<Fault> faults() {
    const std::string obj_points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const std::string many(2000, ' ');
    std::string ring = "f";
    for (int i = 0; i < 1001; ++i) {
        ring += " 1";
    }
    return {
        {"a.obj", "", "is empty"},
        {"a.obj", "# nothing\n", "holds no triangles"},
        {"a.obj", obj_points, "holds no triangles"},
        {"a.obj", obj_points + "f 1 2 4\n", "line 4: vertex index 4 is not in 1..3"},
        {"a.obj", obj_points + "f 0 1 2\n", "vertex index 0 is not in"},
        {"a.obj", obj_points + "f -4 1 2\n", "vertex index -4 is not in"},
        {"a.obj", obj_points + "f 1 2 x\n", "vertex index x is not in"},
        {"a.obj", obj_points + "f 1 2 99999999999999999999\n", "vertex index 9999"},
        {"a.obj", obj_points + "f 1 2\n", "holds no triangles"},
        {"a.obj", obj_points + ring + "\n", "line 4 has 1001 corners"},
        {"a.obj", "v 0 0\n", "line 1: a vertex needs three numbers"},
        {"a.obj", "v 0 zero 0\n", "line 1: a vertex needs three numbers"},
        {"a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 0 is not a number"},
        {"a.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 1 lies beyond 1e12 m"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 2e12 0\nf 1 2 3\n", "vertex 2 lies beyond 1e12 m"},
        {"a.off", "8 6 0\n", "does not begin with OFF"},
        {"a.off", "4OFF\n", "does not begin with OFF"},
        {"a.off", "OFF BINARY\n" + many, "is binary OFF"},
        {"a.off", "OFF\n", "ends before the counts"},
        {"a.off", "OFF\n3\n", "numbers of vertices and faces are missing"},
        {"a.off", "OFF\n-3 1 0\n", "numbers of vertices and faces are missing"},
        {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "ends before vertex 2"},
        {"a.off", "OFF\n3000000000 1 0\n" + kPoints, "ends before vertex 3"},
        {"a.off", "OFF\n3 9000000000000000000 0\n" + kPoints, "ends before face 0"},
        {"a.off", "OFF\n3 1 0\n" + kPoints + "3 0 1 3\n", "face 0: vertex index 3 is not in 0..2"},
        {"a.off", "OFF\n3 1 0\n" + kPoints + "3 0 1 -1\n", "vertex index -1"},
        {"a.off", "OFF\n3 1 0\n" + kPoints + "3 0 1\n", "3 corners are claimed, 2 are there"},
        {"a.off", "OFF\n3 1 0\n" + kPoints + "9999999999 0 1 2\n", "corners are claimed"},
        {"a.off", "OFF\n3 0 0\n" + kPoints, "holds no triangles"},
        {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 -nan\n0 1 0\n3 0 1 2\n", "vertex 1 is not a number"},
        {"a.stl", "tiny", "is truncated"},
        {"a.stl", stl_of(2, kFacet), "1 of 2 triangles are there"},
        {"a.stl", stl_of(4294967295U, kFacet), "1 of 4294967295 triangles"},
        {"a.stl", stl_of(0, ""), "holds no triangles"},
        {"a.stl",
         stl_of(1, float_bytes({0, 0, 0, 0, 0, NAN, 1, 0, 0, 0, 1, 0}) + "ab"),
         "vertex 0 is not a number"},
        {"a.stl", "solid a\nfacet\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n", "truncated"},
        {"a.stl",
         "solid a\n vertex 0 0 0\n vertex 1 0 0\n endloop\nendsolid\n" + many,
         "line 4: a facet has 2 vertices"},
        {"a.stl",
         "solid a\n vertex 0 0 0\n vertex 1 0 0\n vertex 1 0 0\n vertex 1 1 1\n" + many,
         "line 5: a facet needs three vertices"},
        {"a.stl", "solid a\n vertex 0 0 one\n" + many, "three vertices of three numbers"},
        {"a.ply", "plymouth\n", "does not begin with ply"},
        {"a.ply", "ply\nformat ascii 1.0\n", "header does not end"},
        {"a.ply", "ply\nend_header\n", "PLY does not know: line 2"},
        {"a.ply", "ply\nformat morse 1.0\nend_header\n", "format is none of PLY's"},
        {"a.ply", ply("element vertex\n", ""), "element without a count"},
        {"a.ply", ply("element vertex -1\n", ""), "element without a count"},
        {"a.ply", ply("element vertex 1\nproperty quad x\n", ""), "property of type \"quad\""},
        {"a.ply", ply("element vertex 99999999999999999\n", ""), "claims 99999999999999999"},
        {"a.ply",
         ply("element vertex 4000000000\nproperty float x\n", "1 2 3"),
         "claims 4000000000 elements \"vertex\""},
        {"a.ply", ply("element vertex 1\nproperty float x\n", "1 \n"), "vertices have no y"},
        {"a.ply",
         ply(kThree + "element face 1\nproperty list uchar int corners\n", kPoints + "3 0 1 2\n"),
         "faces have no vertex_indices"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "3 0 1"), "truncated"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "3 0 1 3\n"), "face 0: vertex index 3"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "3 0 1 -2\n"), "face 0: vertex index -2"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "3 0 1 1.5\n"), "not a whole number"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "3 0 1 nan\n"), "not a whole number"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "4e9 0 1 2\n"), "list of a length"},
        {"a.ply", ply(kThree + kOneFace, kPoints + "-3 0 1 2\n"), "list of a length"},
        {"a.ply", ply(kThree + kOneFace, "0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n"), "\"zero\""},
        {"a.ply", ply(kThree + kOneFace, "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"), "not a number"},
        {"a.ply", ply(kThree, kPoints), "holds no triangles"},
        {"a.ply",
         ply("element tristrips 1\nproperty list int int vertex_indices\n", "1 1\n"),
         "triangle strips"},
        {"a.ply",
         "ply\nformat binary_little_endian 1.0\n" + kThree + kOneFace + "end_header\n" +
             float_bytes({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\x03",
         "too short for"},
    };
}

std::string line_for(const std::filesystem::path& file) {
    try {
        load_scene(file);
        return "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), file.string());
        EXPECT_FALSE(error.remedy().empty()) << error.line();
        return error.line();
    } catch (const std::exception& error) {
        return std::string("not an earshot::Error: ") + error.what();
    }
}

TEST(MeshFaults, EachIsOneClearLine) {
    const test::TemporaryFolder folder;
    ASSERT_GE(faults().size(), 40U);
    for (const Fault& fault : faults()) {
        const std::string line = line_for(folder.file(fault.name, fault.bytes));
        EXPECT_NE(line.find(fault.expected), std::string::npos)
            << fault.name << " " << fault.bytes.substr(0, 60) << "\n  " << line;
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
}

TEST(MeshFaults, PlacesWhereNoSceneIs) {
    const test::TemporaryFolder folder;
    EXPECT_NE(line_for(folder.path() / "absent.obj").find("no such file"), std::string::npos);
    EXPECT_NE(line_for(folder.path()).find("is a directory"), std::string::npos);
    const std::string unknown = line_for(folder.file("a.fbx", "x"));
    EXPECT_NE(unknown.find("unknown suffix: .fbx; use .gltf"), std::string::npos) << unknown;
    EXPECT_NE(line_for(folder.file("a", "x")).find("has no suffix"), std::string::npos);
    for (const char* name : {"a.glb", "a.gltf", "a.ply", "a.stl", "a.off", "a.OBJ"}) {
        EXPECT_NE(line_for(folder.file(name, "")).find("is empty"), std::string::npos) << name;
    }
}

TEST(MeshFaults, TruncatedFilesNeverCrash) {
    for (const char* name : {"cloth_ball92.ply", "stanford-bunny.obj", "Fox.glb", "robot.glb"}) {
        const auto model = test::shared_file("models") / name;
        if (!std::filesystem::exists(model)) {
            GTEST_SKIP() << "reference model " << name << " is not here";
        }
        const test::TemporaryFolder folder;
        const auto copy = folder.path() / name;
        std::filesystem::copy_file(model, copy);
        std::filesystem::permissions(copy, std::filesystem::perms::owner_all);
        const auto size = std::filesystem::file_size(copy);
        for (std::uintmax_t part = 49; part > 3; part -= 3) {
            std::filesystem::resize_file(copy, size * part / 50);
            const std::string line = line_for(copy);  // an OBJ may well load
            EXPECT_EQ(line.find("not an earshot::Error"), std::string::npos) << line;
        }
    }
}

}  // namespace
}  // namespace earshot::io
