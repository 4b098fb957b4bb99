// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_mending.h"

#include "earshot/base/error.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/room_shapes.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/boxes.h"
#include "support/cut_opening.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>

namespace earshot::propagation {
namespace {

using geometry::Mesh;
using geometry::TriangleId;
using geometry::Vec3;

constexpr ModelCheckOptions kNoForecast{.forecast_seconds = 0.0};

class ModelMending : public testing::Test {
protected:
    void SetUp() override {
        if (!geometry::topology_available()) {
            GTEST_SKIP() << "this build is without OpenMesh";
        }
    }
};

/// A box whose fronts are outside.
void add_solid(Mesh& mesh, const Vec3& lower, const Vec3& upper) {
    support::add_box(mesh, lower, upper, false);
}

Scene room_with(const Mesh& more) {
    Scene scene = shoebox_room({6.0, 3.0, 4.0});
    Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    for (const auto& [a, b, c] : more.triangles) {
        mesh.triangles.push_back({a + first, b + first, c + first});
    }
    scene.material_of_triangle.resize(mesh.triangles.size(), 0);
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.sources.push_back({.name = "s", .position = {4, 1, 1}});
    scene.listeners.push_back({.name = "l", .position = {5, 2, 3}});
    return scene;
}

std::vector<TriangleId> range(TriangleId first, std::size_t count) {
    std::vector<TriangleId> ids;
    for (std::size_t i = 0; i < count; ++i) {
        ids.push_back(first + static_cast<TriangleId>(i));
    }
    return ids;
}

/// A box of which one triangle is a hundredth of a millimetre off, so that it is not closed.
void add_ajar(Mesh& mesh, const Vec3& lower, const Vec3& upper) {
    add_solid(mesh, lower, upper);
    const auto [a, b, c] = mesh.triangles.back();
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    const Vec3 normal = glm::normalize(
        glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
    for (const geometry::VertexId v : {a, b, c}) {
        mesh.positions.push_back(mesh.positions[v] + 1e-5 * normal);
    }
    mesh.triangles.back() = {first, first + 1, first + 2};
}

TEST_F(ModelMending, RemovesWhatIsProvedOutOfReachAndKeepsWhatRaysAloneMissed) {
    // A closed box with a box in it, which a closed surface keeps from all. And a box in a box in a
    // box, the outer ones ajar: guided sampling finds the first gap, hardly a ray the second, and
    // nothing proves that there is no way.
    Mesh more;
    add_solid(more, {1, 1, 1}, {2, 2, 2});
    add_solid(more, {1.4, 1.4, 1.4}, {1.6, 1.6, 1.6});
    add_ajar(more, {1, 1, 2.5}, {2, 2, 3.5});
    add_ajar(more, {1.2, 1.2, 2.7}, {1.8, 1.8, 3.3});
    add_solid(more, {1.4, 1.4, 2.9}, {1.6, 1.6, 3.1});
    const Scene scene = room_with(more);
    const ModelReport report = check_model(scene, kNoForecast);
    const MendedModel mended = mend_model(scene, report, {.max_hole_area = 0.0});
    // The shoe-box has 12 triangles, each box 12.
    EXPECT_EQ(mended.report.unreached, range(24, 12));
    EXPECT_EQ(mended.report.doubtful, range(60, 12));
    EXPECT_EQ(mended.scene.mesh.triangles().size(), 60U);
    EXPECT_EQ(mended.scene.material_of_triangle.size(), 60U);
}

TEST_F(ModelMending, TellsAllThatItRemovesAndTurns) {
    Mesh more;
    add_solid(more, {1, 1, 1}, {2, 2, 2});
    // Turned: its fronts look into it. Then a copy of its first triangle, the other way round, and
    // a triangle without area.
    for (geometry::Triangle& triangle : more.triangles) {
        std::swap(triangle[1], triangle[2]);
    }
    const auto [a, b, c] = more.triangles[0];
    more.triangles.push_back({a, c, b});
    more.triangles.push_back({a, a, b});
    const Scene scene = room_with(more);
    const MendedModel mended = mend_model(scene, check_model(scene, kNoForecast));
    EXPECT_EQ(mended.report.turned, range(12, 12));
    EXPECT_EQ(mended.report.doubled, range(24, 1));
    EXPECT_EQ(mended.report.degenerate, range(25, 1));
    EXPECT_TRUE(mended.report.unreached.empty());
    const ModelReport again = check_model(mended.scene, kNoForecast);
    EXPECT_TRUE(again.reversed_triangles.empty());
    EXPECT_TRUE(again.doubled.empty());
    EXPECT_NEAR(again.airs.at(0).volume, 71.0, 1e-9);
}

TEST_F(ModelMending, FillsHolesUpToASize) {
    Scene scene = room_with({});
    const auto cut = support::cut_opening(scene, 3, 0.5, 0.2);
    ASSERT_TRUE(cut);
    const ModelReport report = check_model(scene, kNoForecast);
    ASSERT_EQ(report.leaks.size(), 1U);
    EXPECT_TRUE(mend_model(scene, report, {.max_hole_area = 0.09}).report.filled.empty());
    const MendedModel mended = mend_model(scene, report, {.max_hole_area = 0.11});
    ASSERT_EQ(mended.report.filled.size(), 1U);
    const ModelReport again = check_model(mended.scene, kNoForecast);
    EXPECT_TRUE(again.leaks.empty());
    EXPECT_TRUE(again.topology.holes.empty());
    EXPECT_TRUE(again.reversed_triangles.empty());
    EXPECT_NEAR(again.airs.at(0).volume, 72.0, 1e-9);
}

TEST_F(ModelMending, OfASceneThatMovesOneInstantIsMended) {
    const Scene scene = io::load_scene(test::source_file("scenes/door.gltf")).scene;
    ModelCheckOptions options = kNoForecast;
    options.time = 0.7;
    const ModelReport report = check_model(scene, options);
    EXPECT_THROW(mend_model(scene, report, {.time = 0.7}), Error);
    const MendedModel mended = mend_model(scene, report, {.time = 0.7, .freeze = true});
    EXPECT_EQ(mended.scene.mesh.duration(), 0.0);
    // Every corner lies where it was.
    const std::vector<Vec3> before = scene.mesh.positions_at(0.7);
    const std::vector<Vec3> after = mended.scene.mesh.positions_at(0.0);
    ASSERT_EQ(mended.scene.mesh.triangles().size(), scene.mesh.triangles().size());
    for (std::size_t t = 0; t < scene.mesh.triangles().size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(after[mended.scene.mesh.triangles()[t][k]],
                      before[scene.mesh.triangles()[t][k]]);
        }
    }
    EXPECT_EQ(mended.scene.listeners[0].position, scene.position_at(scene.listeners[0], 0.7));
}

}  // namespace
}  // namespace earshot::propagation
