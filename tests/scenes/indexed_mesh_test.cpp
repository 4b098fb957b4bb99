// SPDX-License-Identifier: MIT
#include "earshot/scenes/indexed_mesh.h"

#include "earshot/scenes/models.h"

#include "scenes/generated_mesh.h"
#include <algorithm>

namespace earshot::scenes {
namespace {

TEST(IndexedMesh, SharesVerticesAcrossMaterials) {
    Faces faces;
    faces.push_back({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}, 4, 0});
    faces.push_back({{Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(1, 1, 0)}, 4, 1});
    DraftNode node;
    node.faces = faces;
    const IndexedMesh mesh = index_faces(node, 2, 1);
    EXPECT_EQ(mesh.positions.size(), 6U);
    ASSERT_EQ(mesh.triangles.size(), 2U);
    EXPECT_EQ(mesh.triangles[0].size(), 2U);
    EXPECT_EQ(mesh.triangles[1].size(), 2U);
    EXPECT_TRUE(std::is_sorted(mesh.positions.begin(), mesh.positions.end()));
}

TEST(IndexedMesh, TessellationKeepsRoomsClosedAndTheirVolume) {
    for (const SceneDraft& draft : {make_shoebox(), make_lroom(), make_coupled_rooms()}) {
        const DraftNode& room = draft.nodes.front();
        const geometry::Mesh whole = mesh_of(room);
        for (const int n : {2, 3, 7}) {
            const geometry::Mesh split = mesh_of(room, n);
            EXPECT_TRUE(is_closed(split)) << draft.name << " " << n;
            EXPECT_EQ(split.triangles.size(),
                      whole.triangles.size() * static_cast<std::size_t>(n * n));
            EXPECT_NEAR(signed_volume(split), signed_volume(whole), 1e-4) << draft.name << " " << n;
        }
    }
}

TEST(IndexedMesh, TessellatedHallStaysClosed) {
    const SceneDraft draft = make_concert_hall({.seats = Seats::blocks});
    for (const char* name : {"hall", "canopy"}) {
        EXPECT_TRUE(is_closed(mesh_of(node_named(draft, name), 3))) << name;
    }
}

TEST(IndexedMesh, GrowsToMillionsOfTriangles) {
    const SceneDraft draft = make_shoebox();
    const IndexedMesh mesh = index_faces(draft.nodes.front(), 1, 300);
    EXPECT_EQ(mesh.triangle_count(), 12U * 300U * 300U);
    EXPECT_EQ(mesh.positions.size(), 6U * 300U * 300U + 2U) << "V = F / 2 + 2 (Euler)";
}

}  // namespace
}  // namespace earshot::scenes
