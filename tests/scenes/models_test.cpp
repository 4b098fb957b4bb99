// SPDX-License-Identifier: MIT
#include "earshot/scenes/models.h"

#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"
#include "earshot/io/scene_file.h"

#include "scenes/generated_mesh.h"
#include "support/test_paths.h"
#include <filesystem>
#include <map>

namespace earshot::scenes {
namespace {

// Solid angles of thousands of triangles add up to a whole number but for rounding.
constexpr double kWindingTolerance = 1e-9;

constexpr double kVolumeTolerance = 1e-3;  // float coordinates up to 42 m, walls of 1000 m2

bool is_sheet(const DraftNode& node) {
    return node.name == "curtain";
}

std::size_t triangles_of(const SceneDraft& draft) {
    std::size_t count = 0;
    for (const DraftNode& node : draft.nodes) {
        count += node.faces.empty() ? 0 : mesh_of(node).triangles.size();
    }
    return count;
}

TEST(Models, HaveTheStatedNumbersOfTriangles) {
    const std::map<std::string, std::size_t> expected = {{"shoebox", 12},
                                                         {"lroom", 20},
                                                         {"coupled_rooms", 44},
                                                         {"classroom", 1336},
                                                         {"concert_hall", 9684},
                                                         {"door", 56},
                                                         {"curtain", 628},
                                                         {"city", 16404}};
    for (const SceneDraft& draft : make_all()) {
        EXPECT_EQ(triangles_of(draft), expected.at(draft.name)) << draft.name;
    }
}

TEST(Models, AreClosedManifolds) {
    std::vector<SceneDraft> drafts = make_all();
    drafts.push_back(make_concert_hall({.seats = Seats::none}));
    drafts.push_back(make_concert_hall({.seats = Seats::blocks}));
    drafts.push_back(make_classroom({.furnished = false}));
    drafts.push_back(make_coupled_rooms({.opening = 3.4}));
    for (const SceneDraft& draft : drafts) {
        for (const DraftNode& node : draft.nodes) {
            if (!node.faces.empty() && !is_sheet(node)) {
                EXPECT_TRUE(is_closed(mesh_of(node))) << draft.name << " " << node.name;
            }
        }
    }
}

TEST(Models, PassTheCleanUpWithoutRemark) {
    for (const SceneDraft& draft : make_all()) {
        for (const DraftNode& node : draft.nodes) {
            if (node.faces.empty() || is_sheet(node)) {
                continue;
            }
            const geometry::Mesh mesh = mesh_of(node);
            geometry::CleanReport expected;
            expected.triangles_read = mesh.triangles.size();
            expected.vertices_read = mesh.positions.size();
            EXPECT_EQ(geometry::clean(mesh.view()).report, expected)
                << draft.name << " " << node.name;
        }
    }
}

// The first node with geometry is the room; all else is furniture in it.
TEST(Models, SourcesAndListenersAreInTheAir) {
    for (const SceneDraft& draft : make_all()) {
        for (const DraftNode& emitter : draft.nodes) {
            if (emitter.role == Role::none) {
                continue;
            }
            const DraftNode* room = &draft.nodes.front();
            for (const DraftNode& node : draft.nodes) {
                if (node.faces.empty() || is_sheet(node)) {
                    continue;
                }
                const double winding =
                    winding_number(mesh_of(node), emitter.translation - node.translation);
                EXPECT_NEAR(winding, &node == room ? -1.0 : 0.0, kWindingTolerance)
                    << draft.name << ": " << emitter.name << " and " << node.name;
            }
        }
    }
}

TEST(Models, HaveAtLeastOneSourceAndOneListener) {
    for (const SceneDraft& draft : make_all()) {
        int sources = 0;
        int listeners = 0;
        for (const DraftNode& node : draft.nodes) {
            sources += node.role == Role::source ? 1 : 0;
            listeners += node.role == Role::listener ? 1 : 0;
        }
        EXPECT_GE(sources, 1) << draft.name;
        EXPECT_GE(listeners, draft.name == "concert_hall" ? 4 : 1) << draft.name;
    }
}

TEST(Models, RoomsHaveTheVolumesOfTheirPlans) {
    const auto volume = [](const SceneDraft& draft) {
        return -signed_volume(mesh_of(draft.nodes.front()));
    };
    EXPECT_NEAR(volume(make_shoebox()), 8.0 * 3.5 * 6.0, kVolumeTolerance);
    EXPECT_NEAR(volume(make_shoebox({.size = {3.0, 2.5, 4.0}})), 30.0, kVolumeTolerance);
    EXPECT_NEAR(volume(make_lroom()), 81.0, kVolumeTolerance);
    EXPECT_NEAR(volume(make_coupled_rooms()),
                7.0 * 4.0 * 6.0 + 5.0 * 2.8 * 5.2 + 0.2 * 2.1 * 1.2,
                kVolumeTolerance);
    EXPECT_NEAR(volume(make_door()),
                4.6 * 2.7 * 3.8 + 6.7 * 2.7 * 5.0 + 1.0 * 2.1 * 0.15,
                kVolumeTolerance);
}

// Beranek 2004: halls of this kind hold 10,000 to 20,000 m3.
TEST(Models, ConcertHallHasTheVolumeOfOne) {
    const double volume = -signed_volume(mesh_of(make_concert_hall().nodes.front()));
    EXPECT_GT(volume, 9000.0);
    EXPECT_LT(volume, 42.0 * 20.0 * 16.0);
}

geometry::Facets facets_of(const io::LoadedScene& loaded) {
    const geometry::Mesh mesh{loaded.scene.mesh.positions_at(0.0), loaded.scene.mesh.triangles()};
    const geometry::CleanMesh clean = geometry::clean(mesh.view());
    return geometry::find_facets(mesh.view(), clean.weld, loaded.scene.material_of_triangle);
}

TEST(Models, LoadWithoutWarningAsAuthored) {
    for (const SceneDraft& draft : make_all()) {
        const auto file = test::source_file("scenes") / (draft.name + ".gltf");
        const io::LoadedScene loaded = io::load_scene(file);
        EXPECT_TRUE(loaded.warnings.empty()) << draft.name;
        EXPECT_TRUE(io::warnings_of_acoustics(loaded).empty()) << draft.name;
        EXPECT_EQ(loaded.scene.mesh.triangles().size(), triangles_of(draft)) << draft.name;
        for (const auto& emitters : {loaded.scene.sources, loaded.scene.listeners}) {
            for (const propagation::Emitter& emitter : emitters) {
                EXPECT_EQ(loaded.scene.position_at(emitter, 0.0),
                          node_named(draft, emitter.name).translation)
                    << draft.name << " " << emitter.name;
            }
        }
        ASSERT_EQ(loaded.scene.materials.size(), draft.materials.size()) << draft.name;
        for (std::size_t i = 0; i < draft.materials.size(); ++i) {
            const propagation::Material& material = loaded.scene.materials[i];
            const SurfaceMaterial& drafted = draft.materials[i];
            const auto row = propagation::find_library_material(drafted.library);
            constexpr std::size_t k500Hz = 2;
            EXPECT_EQ(material.name, drafted.name);
            EXPECT_EQ(material.absorption.at(500.0),
                      drafted.row_absorption ? (*drafted.row_absorption)[k500Hz]
                      : row                  ? row->absorption.at(500.0)
                                             : 0.2)
                << draft.name << " " << material.name;
            EXPECT_EQ(material.scattering.at(500.0),
                      drafted.row_scattering ? (*drafted.row_scattering)[k500Hz]
                      : row                  ? row->scattering.at(500.0)
                                             : 0.0)
                << draft.name << " " << material.name;
        }
    }
}

// The closed form of the box and of the L room is that of mirrors.
TEST(Models, WallsOfTheClosedFormsSayThatTheyScatterNothing) {
    for (const char* name : {"shoebox.gltf", "lroom.gltf"}) {
        const auto file = test::source_file("scenes") / name;
        for (const auto& material : io::load_scene(file).scene.materials) {
            for (const double frequency_hz : {31.5, 1000.0, 16000.0}) {
                EXPECT_EQ(material.scattering.at(frequency_hz), 0.0) << name;
            }
        }
    }
}

TEST(Models, StructureScattersByItsDepth) {
    SceneDraft draft;
    const std::size_t wall = draft.library_material("marble", {});
    draft.set_structure(wall, 0.1);
    // 0.5 sqrt(0.1 f / 343.2): 0.095, 0.135, 0.191, 0.270, 0.382, 0.540, 0.763.
    EXPECT_EQ(*draft.materials[wall].row_scattering,
              (Octaves{0.1, 0.13, 0.19, 0.27, 0.38, 0.54, 0.76}));
    draft.spread_row(wall, "audience-upholstered-seats", 0.5);
    EXPECT_EQ((*draft.materials[wall].row_absorption)[0], 0.31);
    EXPECT_EQ(draft.materials[wall].name, "marble");
}

TEST(Models, ShoeboxHasSixFacets) {
    const auto file = test::source_file("scenes/shoebox.gltf");
    EXPECT_EQ(facets_of(io::load_scene(file)).facets.size(), 6U);
}

}  // namespace
}  // namespace earshot::scenes
