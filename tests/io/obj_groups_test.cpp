// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <string>
#include <vector>

namespace earshot::io {
namespace {

/// Four triangles' worth of vertices; faces refer to them.
const std::string kVertices =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 0 0 2\nv 1 0 2\nv 0 1 2\n"
    "v 0 0 3\nv 1 0 3\nv 0 1 3\n";

struct Meshes {
    std::vector<std::string> names;
    std::vector<std::uint32_t> of_triangle;

    friend bool operator==(const Meshes&, const Meshes&) = default;
};

std::ostream& operator<<(std::ostream& stream, const Meshes& meshes) {
    for (const std::string& name : meshes.names) {
        stream << '"' << name << "\" ";
    }
    for (const std::uint32_t mesh : meshes.of_triangle) {
        stream << mesh << ' ';
    }
    return stream;
}

class ObjGroups : public testing::Test {
protected:
    Meshes meshes_of(const std::string& body) {
        const LoadedScene loaded = load_scene(folder_.file("model.obj", kVertices + body));
        return {loaded.scene.mesh.mesh_names(), loaded.scene.mesh.mesh_of_triangle()};
    }

    test::TemporaryFolder folder_;
};

TEST_F(ObjGroups, ObjectsAreMeshes) {
    EXPECT_EQ(meshes_of("o left\nf 1 2 3\no right\nf 4 5 6\nf 5 6 4\n"),
              (Meshes{{"left", "right"}, {0, 1, 1}}));
}

TEST_F(ObjGroups, GroupsThatShareAVertexAreOneMesh) {
    EXPECT_EQ(meshes_of("g a\nf 1 2 3\ng b\nf 4 5 6\ng c\nf 3 7 8\ng d\nf 10 11 12\n"),
              (Meshes{{"a", "b", "d"}, {0, 1, 0, 2}}));
    // The last face joins what was apart until then.
    EXPECT_EQ(meshes_of("g a\nf 1 2 3\ng b\nf 4 5 6\ng c\nf 7 8 9\ng d\nf 9 6 10\n"),
              (Meshes{{"a", "b"}, {0, 1, 1, 1}}));
}

TEST_F(ObjGroups, AGroupGoesOnWhereItsNameComesAgain) {
    EXPECT_EQ(meshes_of("g a\nf 1 2 3\ng b\nf 4 5 6\ng a\nf 7 8 9\n"),
              (Meshes{{"a", "b"}, {0, 1, 0}}));
}

TEST_F(ObjGroups, ObjectsOfOneNameAreTwo) {
    EXPECT_EQ(meshes_of("o thing\nf 1 2 3\no thing\nf 4 5 6\n"),
              (Meshes{{"thing", "thing"}, {0, 1}}));
    // A group of the same name belongs to another object.
    EXPECT_EQ(meshes_of("o one\ng part\nf 1 2 3\no two\ng part\nf 4 5 6\n"),
              (Meshes{{"one", "two"}, {0, 1}}));
}

TEST_F(ObjGroups, WhatHasNoNameTakesThatOfTheFile) {
    EXPECT_EQ(meshes_of("f 1 2 3\nf 4 5 6\n"), (Meshes{{"model"}, {0, 0}}));
    EXPECT_EQ(meshes_of("f -1 -2 -3\no rest\nf 1 2 3\ng\nf 4 5 6\n"),
              (Meshes{{"model", "rest"}, {0, 1, 1}}));
}

TEST_F(ObjGroups, MaterialsAndPolygonsMakeNoMeshes) {
    EXPECT_EQ(meshes_of("o a b\nusemtl x\nf 1 2 5 4\nusemtl y\nf 7 8 9\ng empty\n"),
              (Meshes{{"a b"}, {0, 0, 0}}));
}

}  // namespace
}  // namespace earshot::io
