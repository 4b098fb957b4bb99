// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_check.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/model_findings.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "support/boxes.h"
#include "support/cut_opening.h"
#include "support/meshes.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace earshot::propagation {
namespace {

using geometry::Mesh;
using geometry::TriangleId;
using geometry::Vec3;

Scene scene_of(Mesh mesh) {
    Scene scene;
    scene.name = "room";
    scene.materials.push_back({.name = "wall", .scattering = EnergyCoefficient(0.1)});
    scene.material_of_triangle.assign(mesh.triangles.size(), 0);
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

void place(Scene& scene, const Vec3& source, const Vec3& listener) {
    scene.sources.push_back({.name = "s", .position = source});
    scene.listeners.push_back({.name = "l", .position = listener});
}

/// 6 x 3 x 4 m with a closed cupboard in it and another room of 3 x 3 x 4 m beside it.
Mesh house() {
    Mesh mesh;
    support::add_box(mesh, {0, 0, 0}, {6, 3, 4}, true);
    support::add_box(mesh, {1, 0.1, 1}, {2, 2, 1.5}, false);
    support::add_box(mesh, {6.2, 0, 0}, {9.2, 3, 4}, true);
    return mesh;
}

constexpr ModelCheckOptions kNoForecast{.forecast_seconds = 0.0};

std::vector<Finding> findings(const Scene& scene, const ModelReport& report) {
    return model_findings(scene, report);
}

bool tells(const std::vector<Finding>& list, const std::string& part) {
    return std::any_of(list.begin(), list.end(), [&](const Finding& finding) {
        return finding.text.find(part) != std::string::npos;
    });
}

class ModelCheck : public testing::Test {
protected:
    void SetUp() override {
        if (!geometry::topology_available()) {
            GTEST_SKIP() << "this build is without OpenMesh";
        }
    }
};

TEST_F(ModelCheck, ABoxIsCleanAndItsAirIsExact) {
    Scene scene = shoebox_room({6.0, 3.0, 4.0});
    place(scene, {1, 1, 1}, {4, 2, 3});
    const ModelReport report = check_model(scene);
    EXPECT_EQ(gravest(findings(scene, report)), Severity::note);
    ASSERT_EQ(report.airs.size(), 1U);
    EXPECT_NEAR(report.airs[0].volume, 72.0, 1e-9);
    EXPECT_NEAR(report.airs[0].surface, 108.0, 1e-9);
    EXPECT_TRUE(report.leaks.empty());
    EXPECT_TRUE(report.unreached.empty());
    EXPECT_FALSE(report.is_open);
    ASSERT_EQ(report.costs.size(), 5U);
    for (std::size_t i = 0; i < report.costs.size(); ++i) {
        EXPECT_EQ(report.costs[i].order, static_cast<int>(i) + 2);
        EXPECT_GT(report.costs[i].seconds, 0.0);
    }
}

TEST_F(ModelCheck, WithoutSourcesTheLargestAirIsLookedFor) {
    const Scene scene = scene_of(house());
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_TRUE(report.probe);
    ASSERT_EQ(report.airs.size(), 1U);
    EXPECT_NEAR(report.airs[0].volume, 72.0 - 1.9 * 0.5, 1e-9);
    EXPECT_TRUE(report.costs.empty());
}

TEST_F(ModelCheck, ASourceInASolidIsToldFirst) {
    Scene scene = scene_of(house());
    place(scene, {1.5, 1, 1.2}, {4, 1, 3});
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_EQ(report.misplaced.size(), 2U);  // nor has the listener a source
    EXPECT_EQ(report.misplaced[0].fault, EmitterFault::in_solid);
    EXPECT_TRUE(report.misplaced[0].is_source);
    EXPECT_TRUE(report.misplaced[0].is_proven);
    const auto list = findings(scene, report);
    EXPECT_EQ(list[0].severity, Severity::unusable);
    EXPECT_NE(list[0].text.find("source \"s\" at 1.5, 1, 1.2 is inside a solid"), std::string::npos)
        << list[0].text;
}

TEST_F(ModelCheck, AListenerInASealedRoomIsToldFirst) {
    Scene scene = scene_of(house());
    place(scene, {4, 1, 1}, {8, 1, 3});
    const ModelReport report = check_model(scene, kNoForecast);
    EXPECT_EQ(report.airs.size(), 2U);
    const auto list = findings(scene, report);
    EXPECT_TRUE(tells(list, "listener \"l\" at 8, 1, 3 is in a sealed room")) << list[0].text;
    EXPECT_EQ(list[0].severity, Severity::unusable);
}

TEST_F(ModelCheck, AListenerOutsideIsTold) {
    Scene scene = shoebox_room({6.0, 3.0, 4.0});
    place(scene, {1, 1, 1}, {4, 2, 9});
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_FALSE(report.misplaced.empty());
    EXPECT_EQ(report.misplaced.back().fault, EmitterFault::outside);
    EXPECT_TRUE(report.misplaced.back().is_proven);
    EXPECT_FALSE(report.misplaced.back().is_source);
}

TEST_F(ModelCheck, BesideAReflectorInTheOpenNothingIsMisplaced) {
    Mesh mesh;
    mesh.positions = {{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}};
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
    Scene scene = scene_of(mesh);
    place(scene, {0, 2, 0}, {1, 2, 0});
    EXPECT_TRUE(check_model(scene, kNoForecast).misplaced.empty());
}

TEST_F(ModelCheck, ReversedFacesAreToldByPlace) {
    Mesh mesh = house();
    // The cupboard inside out: its fronts look into it.
    for (TriangleId t = 12; t < 24; ++t) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
    Scene scene = scene_of(mesh);
    place(scene, {4, 1, 1}, {5, 1, 3});
    ModelReport report = check_model(scene, kNoForecast);
    ASSERT_EQ(report.reversed.size(), 1U);
    EXPECT_EQ(report.reversed[0].triangles, 12U);
    EXPECT_EQ(report.reversed[0].first_triangle, 12U);
    EXPECT_NEAR(report.reversed[0].place.centre.x, 1.5, 1e-12);
    EXPECT_TRUE(tells(findings(scene, report), "12 faces are reversed"));

    for (geometry::Triangle& triangle : mesh.triangles) {
        std::swap(triangle[1], triangle[2]);
    }
    for (TriangleId t = 12; t < 24; ++t) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
    scene = scene_of(mesh);
    place(scene, {4, 1, 1}, {5, 1, 3});
    report = check_model(scene, kNoForecast);
    EXPECT_EQ(report.reversed_triangles.size(), 24U);
    EXPECT_TRUE(tells(findings(scene, report), "the model is inside out"));
    EXPECT_TRUE(report.misplaced.empty());
}

TEST_F(ModelCheck, DoubledFacesAndInchesAreTold) {
    Mesh mesh = house();
    for (TriangleId t = 0; t < 12; ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        mesh.triangles.push_back({a, c, b});
    }
    for (Vec3& p : mesh.positions) {
        p /= 0.0254;
    }
    Scene scene = scene_of(mesh);
    place(scene, Vec3(4, 1, 1) / 0.0254, Vec3(5, 1, 3) / 0.0254);
    const ModelReport report = check_model(scene, kNoForecast);
    const auto list = model_findings(scene, report, true);
    EXPECT_TRUE(tells(list, "12 faces are doubled (12 reversed)"));
    EXPECT_TRUE(tells(list, "--units in makes it"));
    ASSERT_LE(list.size(), 9U);
    EXPECT_TRUE(report.leaks.empty());
}

TEST_F(ModelCheck, LayersCutOtherwiseAreDoubledWhereTheyFaceTheAir) {
    // A wall of the room once more, cut along the other diagonal and turned; and a box that stands
    // on the floor, whose underside is doubled too but faces no air.
    Mesh mesh;
    support::add_box(mesh, {0, 0, 0}, {6, 3, 4}, true);
    support::add_box(mesh, {2, 0, 1}, {3, 1, 2}, false);
    const auto first = static_cast<TriangleId>(mesh.triangles.size());
    mesh.triangles.push_back({0, 2, 1});
    mesh.triangles.push_back({1, 2, 3});
    Scene scene = scene_of(mesh);
    place(scene, {4, 1, 1}, {5, 1, 3});
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_EQ(report.doubled.size(), 1U);
    EXPECT_EQ(report.doubled[0].first_triangle, first);
    EXPECT_EQ(report.doubled[0].triangles, 2U);
    EXPECT_TRUE(report.doubled[0].is_reversed);
    EXPECT_NEAR(report.doubled[0].place.area, 18.0, 1e-6);
    EXPECT_NEAR(report.airs[0].volume, 71.0, 0.1 * 71.0);
}

TEST_F(ModelCheck, MaterialsAreMeasured) {
    Scene scene = shoebox_room({6.0, 3.0, 4.0});
    for (Material& material : scene.materials) {
        material.absorption = material.name == "floor"
                                  ? EnergyCoefficient({{500.0, 0.4}, {1000.0, 0.6}})
                                  : EnergyCoefficient(0.0);
    }
    place(scene, {1, 1, 1}, {4, 2, 3});
    const ModelReport report = check_model(scene, kNoForecast);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const bool is_floor = scene.materials[i].name == "floor";
        EXPECT_EQ(report.materials[i].absorption_share, is_floor ? 1.0 : 0.0);
        EXPECT_EQ(report.materials[i].doubts.empty(), is_floor);
    }
    const std::vector<std::uint32_t> defaults{0};
    ModelCheckOptions options = kNoForecast;
    options.default_materials = defaults;
    EXPECT_TRUE(tells(findings(scene, check_model(scene, options)),
                      "1 material has no acoustic data and takes absorption 0.1: \"floor\""));
}

TEST_F(ModelCheck, GuessedAndDoubtfulMaterialsAreTold) {
    Scene scene = shoebox_room({6.0, 3.0, 4.0});
    scene.materials[0] = *find_library_material("brick-painted");
    scene.materials[1] = scene.materials[0];  // stated, and the library's
    scene.materials[2] = scene.materials[0];
    scene.materials[2].scattering = EnergyCoefficient(0.3);
    place(scene, {1, 1, 1}, {4, 2, 3});
    const std::vector<std::uint32_t> by_name{0};
    ModelCheckOptions options = kNoForecast;
    options.materials_by_name = by_name;
    const ModelReport report = check_model(scene, options);
    EXPECT_EQ(report.materials[0].origin, MaterialOrigin::by_name);
    EXPECT_EQ(report.materials[1].origin, MaterialOrigin::library);
    EXPECT_EQ(report.materials[2].origin, MaterialOrigin::stated);
    EXPECT_TRUE(report.materials[2].doubts.empty());
    const auto list = findings(scene, report);
    EXPECT_TRUE(
        tells(list, "1 material has the library's data by its name alone: \"brick-painted\""));
    // A shoe-box of the library has 0.1 in every band.
    EXPECT_TRUE(tells(list, "3 materials absorb the same at any frequency: "));
    EXPECT_EQ(gravest(list), Severity::note);
}

TEST_F(ModelCheck, OutdoorsTheSkyIsNoDoubtAndTheSizeIsThatOfAPlace) {
    Scene scene = shoebox_room({240.0, 42.0, 240.0});
    for (Material& material : scene.materials) {
        if (material.name != "floor") {
            material.absorption = EnergyCoefficient(1.0);
        }
    }
    place(scene, {10, 2, 10}, {40, 2, 30});
    const ModelReport report = check_model(scene, kNoForecast);
    EXPECT_EQ(report.kind, ModelKind::outdoors);
    EXPECT_FALSE(report.unit);
    EXPECT_EQ(gravest(findings(scene, report)), Severity::note);
}

TEST_F(ModelCheck, SmallFacetsAreTheShareOfTheirArea) {
    // 108 square metres of walls, and a cube of 0.2 m whose facets have diagonals of 0.28 m.
    Mesh mesh;
    support::add_box(mesh, {0, 0, 0}, {6, 3, 4}, true);
    support::add_box(mesh, {2, 1, 1}, {2.2, 1.2, 1.2}, false);
    Scene scene = scene_of(mesh);
    place(scene, {4, 1, 1}, {5, 1, 3});
    const ModelReport report = check_model(scene, kNoForecast);
    for (const SmallFacets& small : report.small_facets) {
        // Half a wavelength at 500 Hz is 0.34 m, at 1 kHz 0.17 m.
        const bool has_cube = small.frequency_hz <= 500.0;
        EXPECT_EQ(small.facets, has_cube ? 6U : 0U) << small.frequency_hz;
        EXPECT_NEAR(small.area_share, has_cube ? 0.24 / 108.24 : 0.0, 1e-12);
    }
    EXPECT_EQ(report.small_facets.size(), 7U);
}

TEST_F(ModelCheck, FewerRaysReachLess) {
    const Scene scene = scene_of(test::sphere(4, 3.0, Vec3(0.0)));
    ModelCheckOptions options = kNoForecast;
    options.max_rays = 2000;
    const ModelReport few = check_model(scene, options);
    options.max_rays = 20'000'000;
    const ModelReport all = check_model(scene, options);
    EXPECT_LT(few.rays, all.rays);
    EXPECT_TRUE(all.unreached.empty());
}

TEST_F(ModelCheck, GapsWithoutALoopAreFound) {
    // Six walls of their own; the ceiling begins 5 cm from the wall x = 0.
    Mesh mesh;
    const auto wall = [&](const Vec3& at, const Vec3& u, const Vec3& v) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        for (const Vec3& p : {at, at + u, at + u + v, at + v}) {
            mesh.positions.push_back(p);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    };
    const Vec3 x(6, 0, 0), y(0, 3, 0), z(0, 0, 4);
    wall({0, 0, 0}, z, x);
    wall({0, 0, 0}, y, z);
    wall({0, 0, 0}, x, y);
    wall(x, z, y);
    wall(z, y, x);
    wall({0.05, 3, 0}, {5.95, 0, 0}, z);
    Scene scene = scene_of(mesh);
    place(scene, {1, 1, 1}, {4, 2, 3});
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_EQ(report.leaks.size(), 1U);
    const Leak& leak = report.leaks[0];
    EXPECT_TRUE(leak.escapes);
    EXPECT_NEAR(leak.place.centre.x, 0.025, 0.05);
    EXPECT_NEAR(leak.place.centre.z, 2.0, 0.2);
    EXPECT_NEAR(leak.place.size.z, 4.0, 0.4);
    EXPECT_NEAR(leak.place.area, 0.2, 0.1);
    EXPECT_FALSE(report.is_open);
}

/// A scene of the project without animation.
Scene project_scene(const std::string& name) {
    return io::load_scene(test::source_file("scenes/" + name + ".gltf")).scene;
}

void expect_cut_found(const Scene& original, double length, double width, std::uint64_t seed) {
    Scene scene = original;
    const auto cut = support::cut_opening(scene, seed, length, width);
    ASSERT_TRUE(cut) << seed;
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_EQ(report.leaks.size(), 1U) << width << ' ' << seed;
    const ModelPlace& place = report.leaks[0].place;
    const Vec3 apart = place.centre - cut->centre;
    EXPECT_LE(std::abs(glm::dot(apart, glm::normalize(cut->along))), 0.5 * length) << seed;
    EXPECT_LE(std::abs(glm::dot(apart, glm::normalize(cut->across))), 0.5 * width) << seed;
    EXPECT_NEAR(place.area, cut->area(), 0.2 * cut->area()) << seed;
    EXPECT_FALSE(report.is_open);
}

TEST_F(ModelCheck, SlitsAndMissingPanelsAreFoundInTheirPlaces) {
    for (const char* name : {"coupled_rooms", "classroom"}) {
        SCOPED_TRACE(name);
        const Scene scene = project_scene(name);
        EXPECT_TRUE(check_model(scene, kNoForecast).leaks.empty());
        expect_cut_found(scene, 1.0, 0.01, 1);
        expect_cut_found(scene, 1.0, 0.05, 2);
        expect_cut_found(scene, 1.0, 0.2, 3);
        expect_cut_found(scene, 1.2, 0.8, 4);
    }
}

TEST_F(ModelCheck, SlowSlitsAndPanelsOfManySeeds) {
    for (const char* name : {"coupled_rooms", "classroom", "concert_hall"}) {
        SCOPED_TRACE(name);
        const Scene scene = project_scene(name);
        EXPECT_TRUE(check_model(scene, kNoForecast).leaks.empty());
        for (const auto& [length, width] :
             {std::pair{1.0, 0.01}, {1.0, 0.05}, {1.0, 0.2}, {1.2, 0.8}}) {
            for (std::uint64_t seed = 10; seed < 15; ++seed) {
                expect_cut_found(scene, length, width, seed);
            }
        }
    }
}

/// A closed surface that a seed chooses: a box, a sphere or a torus, with dents, turned, its fronts
/// anywhere, with closed surfaces inside; and a point in its air.
std::pair<Mesh, Vec3> closed_manifold(std::uint64_t seed) {
    Mesh mesh = seed % 3 == 0   ? test::cube(2 + static_cast<int>(seed % 4), 2.0)
                : seed % 3 == 1 ? test::sphere(2 + static_cast<int>(seed % 2), 2.5, Vec3(0.0))
                                : test::sphere(1, 2.0, Vec3(0.0));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        mesh.positions[v] *= random_between(seed, 0, v, 0.85, 1.15);
    }
    const auto furniture = static_cast<int>(seed % 4);
    for (int i = 0; i < furniture; ++i) {
        const double turn = 2.0 * math::kPi * i / 4.0;
        const Mesh solid = test::sphere(1, 0.2, {math::cos(turn), 0.0, math::sin(turn)});
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), solid.positions.begin(), solid.positions.end());
        for (const auto& [a, b, c] : solid.triangles) {
            mesh.triangles.push_back({a + first, b + first, c + first});
        }
    }
    const glm::dquat turn = glm::normalize(glm::dquat(random_between(seed, 1, 0, -1.0, 1.0),
                                                      random_between(seed, 1, 1, -1.0, 1.0),
                                                      random_between(seed, 1, 2, -1.0, 1.0),
                                                      random_between(seed, 1, 3, 0.1, 1.0)));
    for (Vec3& p : mesh.positions) {
        p = turn * p + Vec3(10.0 * random(seed, 2, 0), 1.0, -3.0);
        for (int axis = 0; axis < 3; ++axis) {
            p[axis] = static_cast<double>(static_cast<float>(p[axis]));
        }
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (random(seed, 3, t) < 0.1) {
            std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        }
    }
    return {mesh, turn * Vec3(0.1, 0.4, 0.1) + Vec3(10.0 * random(seed, 2, 0), 1.0, -3.0)};
}

void expect_no_leak(std::uint64_t seed) {
    const auto [mesh, point] = closed_manifold(seed);
    Scene scene = scene_of(mesh);
    place(scene, point, point + Vec3(0.01, 0.0, 0.02));
    const ModelReport report = check_model(scene, kNoForecast);
    EXPECT_TRUE(report.leaks.empty()) << seed;
    EXPECT_TRUE(report.topology.holes.empty()) << seed;
    EXPECT_TRUE(report.misplaced.empty()) << seed;
}

TEST_F(ModelCheck, ClosedManifoldsDoNotLeak) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        expect_no_leak(seed);
    }
}

TEST_F(ModelCheck, SlowTwoHundredClosedManifoldsDoNotLeak) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        expect_no_leak(seed);
    }
}

/// The paths of a scene without some of its triangles.
std::vector<Path> paths_without(const Scene& scene, const std::vector<TriangleId>& removed) {
    Scene rest = scene;
    Mesh mesh{scene.mesh.positions_at(0.0), {}};
    rest.material_of_triangle.clear();
    for (TriangleId t = 0; t < scene.mesh.triangles().size(); ++t) {
        if (!std::binary_search(removed.begin(), removed.end(), t)) {
            mesh.triangles.push_back(scene.mesh.triangles()[t]);
            rest.material_of_triangle.push_back(scene.material_of_triangle[t]);
        }
    }
    for (Emitter& emitter : rest.sources) {
        emitter = {.name = emitter.name, .position = scene.position_at(emitter, 0.0)};
    }
    for (Emitter& emitter : rest.listeners) {
        emitter = {.name = emitter.name, .position = scene.position_at(emitter, 0.0)};
    }
    rest.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    Simulator simulator(rest, {.specular_order = 2});
    std::vector<Path> paths;
    for (PairResult& pair : simulator.run()) {
        for (Path& path : pair.paths) {
            paths.push_back(std::move(path));
        }
    }
    return paths;
}

/// Adds what no sound can reach: a room beside the scene, and innards to a closed box in it.
void add_hidden(Scene& scene) {
    Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    const SceneExtent extent = scene_extent(scene, 0.0);
    const Vec3 beside = extent.upper + Vec3(1.0);
    support::add_box(mesh, beside, beside + Vec3(3.0), true);
    support::add_box(mesh, beside + 1.0, beside + Vec3(2.0), false);
    const Vec3 at = scene.position_at(scene.sources[0], 0.0) + Vec3(0.3, -0.35, 0.3);
    support::add_box(mesh, at, at + 0.2, false);
    support::add_box(mesh, at + 0.05, at + 0.15, false);
    scene.material_of_triangle.resize(mesh.triangles.size(), 0);
    for (Emitter& emitter : scene.sources) {
        emitter = {.name = emitter.name, .position = scene.position_at(emitter, 0.0)};
    }
    for (Emitter& emitter : scene.listeners) {
        emitter = {.name = emitter.name, .position = scene.position_at(emitter, 0.0)};
    }
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
}

TEST_F(ModelCheck, WithoutWhatIsUnreachedThePathsAreTheSame) {
    for (const char* name : {"shoebox", "coupled_rooms", "classroom", "lroom", "door"}) {
        Scene scene = project_scene(name);
        const auto before = static_cast<TriangleId>(scene.mesh.triangles().size());
        add_hidden(scene);
        const ModelReport report = check_model(scene, kNoForecast);
        // The room beside, the box in it, and the box in a box: all proved. The fronts of the outer
        // boxes' shells belong to the outside of closed rooms.
        EXPECT_GE(report.unreached.size(), 36U) << name;
        EXPECT_GE(report.proven_unreached.size(), 24U) << name;
        for (const TriangleId id : report.proven_unreached) {
            EXPECT_TRUE(std::binary_search(report.unreached.begin(), report.unreached.end(), id));
            EXPECT_GE(id, before) << name;
        }
        const std::vector<Path> all = paths_without(scene, {});
        for (const auto& removed : {report.proven_unreached, report.unreached}) {
            const std::vector<Path> rest = paths_without(scene, removed);
            ASSERT_EQ(rest.size(), all.size()) << name;
            for (std::size_t i = 0; i < all.size(); ++i) {
                EXPECT_EQ(rest[i].length, all[i].length);
                EXPECT_EQ(rest[i].points, all[i].points);
                EXPECT_EQ(rest[i].materials, all[i].materials);
            }
        }
    }
}

TEST_F(ModelCheck, IsTheSameForAnyExecutor) {
    Scene scene = project_scene("coupled_rooms");
    ASSERT_TRUE(support::cut_opening(scene, 5, 1.0, 0.05));
    Executor four(4);
    const ModelReport one = check_model(scene, kNoForecast);
    const ModelReport many = check_model(scene, kNoForecast, four);
    EXPECT_EQ(one.unreached, many.unreached);
    EXPECT_EQ(one.rays, many.rays);
    ASSERT_EQ(one.leaks.size(), many.leaks.size());
    EXPECT_EQ(one.leaks[0].place.area, many.leaks[0].place.area);
    EXPECT_EQ(one.airs[0].volume, many.airs[0].volume);
}

}  // namespace
}  // namespace earshot::propagation
