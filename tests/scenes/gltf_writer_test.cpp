// SPDX-License-Identifier: MIT
#include "earshot/scenes/gltf_writer.h"

#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"
#include "earshot/io/scene_file.h"
#include "earshot/scenes/models.h"

#include "scenes/generated_mesh.h"
#include "support/temporary_folder.h"

namespace earshot::scenes {
namespace {

io::LoadedScene load(const GltfFile& gltf, const std::string& name) {
    const test::TemporaryFolder folder;
    return io::load_scene(folder.file(name, gltf.bytes));
}

TEST(GltfWriter, BothFormsHoldTheSameScene) {
    for (const SceneDraft& draft : make_all()) {
        const auto text = load(write_gltf(draft, GltfForm::text), draft.name + ".gltf").scene;
        const auto binary = load(write_gltf(draft, GltfForm::binary), draft.name + ".glb").scene;
        EXPECT_EQ(text.mesh.triangles(), binary.mesh.triangles()) << draft.name;
        EXPECT_EQ(text.mesh.duration(), binary.mesh.duration()) << draft.name;
        EXPECT_EQ(text.mesh.positions_at(1.0), binary.mesh.positions_at(1.0)) << draft.name;
        EXPECT_EQ(text.material_of_triangle, binary.material_of_triangle) << draft.name;
    }
}

TEST(GltfWriter, CountsWhatItWrites) {
    const GltfFile gltf = write_gltf(make_coupled_rooms(), GltfForm::binary, 4);
    EXPECT_EQ(gltf.triangles, 44U * 16U);
    EXPECT_EQ(gltf.vertices, gltf.triangles / 2 + 2) << "Euler, for a surface like a sphere's";
    const auto scene = load(gltf, "counted.glb").scene;
    EXPECT_EQ(scene.mesh.triangles().size(), gltf.triangles);
}

// 65,535 vertices fit into short indices, one more does not.
TEST(GltfWriter, WritesIndicesOfEitherWidth) {
    for (const int tessellation : {104, 105}) {
        const GltfFile gltf = write_gltf(make_shoebox(), GltfForm::binary, tessellation);
        EXPECT_EQ(gltf.vertices > 65535, tessellation == 105);
        const auto mesh = load(gltf, "wide.glb").scene.mesh;
        const geometry::Mesh loaded{mesh.positions_at(0.0), mesh.triangles()};
        EXPECT_NEAR(signed_volume(loaded), -168.0, 1e-3) << tessellation;
    }
}

// Few enough for image sources by brute force.
TEST(GltfWriter, HallWithBlocksOfSeatsHasAFewHundredFacets) {
    const auto scene =
        load(write_gltf(make_concert_hall({.seats = Seats::blocks}), GltfForm::binary), "hall.glb")
            .scene;
    const geometry::Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    const geometry::CleanMesh clean = geometry::clean(mesh.view());
    const auto facets =
        geometry::find_facets(mesh.view(), clean.weld, scene.material_of_triangle).facets;
    EXPECT_GE(facets.size(), 400U);
    EXPECT_LE(facets.size(), 600U);
    for (const geometry::Facet& facet : facets) {
        EXPECT_LT(facet.deviation, 1e-5) << "splayed walls stay plane but for single precision";
    }
}

}  // namespace
}  // namespace earshot::scenes
