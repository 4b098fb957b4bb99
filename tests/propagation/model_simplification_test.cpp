// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_simplification.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/geometry/simplify.h"
#include "earshot/propagation/model_comparison.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/sampled_distance.h"
#include <algorithm>
#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Mesh;
using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

class ModelSimplification : public ::testing::Test {
protected:
    void SetUp() override {
        if (!geometry::simplify_available()) {
            GTEST_SKIP() << "built without OpenMesh";
        }
    }
};

void append(Mesh& mesh, const Mesh& more) {
    const auto first = static_cast<VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    for (const auto& [a, b, c] : more.triangles) {
        mesh.triangles.push_back({a + first, b + first, c + first});
    }
}

/// A closed box; its fronts face inside or outside.
Mesh box(const Vec3& centre, const Vec3& half_size, int steps, bool inward) {
    Mesh mesh = test::cube(steps, 1.0);
    for (Triangle& triangle : mesh.triangles) {
        const auto [a, b, c] = geometry::corners(mesh.positions, triangle);
        const bool faces_out = glm::dot(glm::cross(b - a, c - a), a + b + c) > 0.0;
        if (faces_out == inward) {
            std::swap(triangle[1], triangle[2]);
        }
    }
    for (Vec3& p : mesh.positions) {
        p = centre + half_size * p;
    }
    return mesh;
}

/// A room of 4 x 3 x 5 m with a ball in it, of another material.
Scene room_with_ball(double radius, int levels) {
    Scene scene;
    scene.name = "room";
    scene.materials = {{.name = "wall", .absorption = EnergyCoefficient(0.1)},
                       {.name = "ball",
                        .absorption = EnergyCoefficient({{125.0, 0.2}, {2000.0, 0.4}}),
                        .scattering = EnergyCoefficient(0.3),
                        .transmission = EnergyCoefficient(0.05)}};
    Mesh mesh = box({2.0, 1.5, 2.5}, {2.0, 1.5, 2.5}, 4, true);
    scene.material_of_triangle.assign(mesh.triangles.size(), 0);
    append(mesh, test::sphere(levels, radius, {1.0, 1.0, 1.0}));
    scene.material_of_triangle.resize(mesh.triangles.size(), 1);
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.sources.push_back({.name = "s", .position = {3.0, 1.5, 1.0}});
    scene.listeners.push_back({.name = "l", .position = {3.0, 1.2, 4.0}});
    return scene;
}

double area_of_material(const Scene& scene, std::uint32_t material) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(0.0);
    double sum = 0.0;
    for (std::size_t t = 0; t < scene.mesh.triangles().size(); ++t) {
        if (scene.material_of_triangle[t] == material) {
            const auto [a, b, c] = geometry::corners(positions, scene.mesh.triangles()[t]);
            sum += 0.5 * glm::length(glm::cross(b - a, c - a));
        }
    }
    return sum;
}

Mesh mesh_of(const Scene& scene) {
    return {scene.mesh.positions_at(0.0), scene.mesh.triangles()};
}

TEST_F(ModelSimplification, KeepsTheDistanceThatItStates) {
    const Scene scene = room_with_ball(0.4, 4);
    const SimplifiedModel model = simplify_model(scene, {.max_distance = 0.02});
    EXPECT_LT(model.report.triangles_after, model.report.triangles_before / 5);
    EXPECT_EQ(model.report.triangles_after, model.scene.mesh.triangles().size());
    EXPECT_LE(model.report.surfaces.upper(), 0.02);
    EXPECT_TRUE(model.report.objects.empty());
    const double there = test::sampled_distance(mesh_of(scene), mesh_of(model.scene), 2).largest;
    const double back = test::sampled_distance(mesh_of(model.scene), mesh_of(scene), 4).largest;
    EXPECT_LE(there, model.report.surfaces.to_simplified.upper + 1e-12);
    EXPECT_LE(back, model.report.surfaces.to_original.upper + 1e-12);
    EXPECT_EQ(model.report.parts, 2U);
}

TEST_F(ModelSimplification, KeepsAbsorptionAreas) {
    const Scene scene = room_with_ball(0.4, 4);
    const SimplifiedModel model = simplify_model(scene, {.max_distance = 0.03});
    for (std::uint32_t m = 0; m < 2; ++m) {
        const double before = area_of_material(scene, m);
        const double after = area_of_material(model.scene, m);
        for (const double f : {63.0, 500.0, 1000.0, 8000.0}) {
            EXPECT_NEAR(scene.materials[m].absorption.at(f) * before,
                        model.scene.materials[m].absorption.at(f) * after,
                        1e-9 * before);
            EXPECT_NEAR(scene.materials[m].transmission.at(f) * before,
                        model.scene.materials[m].transmission.at(f) * after,
                        1e-9 * before);
        }
        EXPECT_NEAR(model.report.materials[m].area_before, before, 1e-9 * before);
        EXPECT_NEAR(model.report.materials[m].area_after, after, 1e-9 * after);
    }
    // The walls are as they were; the ball is smaller, and rougher than it looks.
    EXPECT_FALSE(model.report.materials[0].has_new_data);
    EXPECT_TRUE(model.report.materials[1].has_new_data);
    EXPECT_GT(model.scene.materials[1].scattering.at(1000.0), 0.3);
    EXPECT_EQ(model.scene.materials[1].name, "ball");
}

TEST_F(ModelSimplification, SmallObjectsBecomeBoxesThatAbsorbTheSame) {
    const Scene scene = room_with_ball(0.1, 3);
    const SimplifiedModel model =
        simplify_model(scene, {.max_distance = 0.01, .max_object_size = 0.25});
    ASSERT_EQ(model.report.objects.size(), 1U);
    EXPECT_EQ(model.report.triangles_after, 24U);
    const ReplacedObject& object = model.report.objects[0];
    EXPECT_EQ(object.triangles, 512U);
    EXPECT_LE(2.0 * object.box.half_size.x, 0.21);
    // The corners of a cube are (sqrt(3) - 1) radii from the ball in it, about.
    EXPECT_NEAR(object.change.to_original.upper, 0.0732, 0.01);
    // Nothing else has the material, whose name stays.
    EXPECT_EQ(model.scene.materials.size(), 2U);
    const double before = area_of_material(scene, 1);
    const double after = area_of_material(model.scene, object.material);
    EXPECT_GT(after, before);
    for (const double f : {125.0, 500.0, 2000.0}) {
        EXPECT_NEAR(scene.materials[1].absorption.at(f) * before,
                    model.scene.materials[object.material].absorption.at(f) * after,
                    1e-9);
    }
    EXPECT_GT(model.scene.materials[object.material].scattering.at(1000.0),
              scene.materials[1].scattering.at(1000.0));
}

TEST_F(ModelSimplification, BoxesOfAMaterialThatIsElsewhereHaveOneOfTheirOwn) {
    Scene scene = room_with_ball(0.1, 3);
    std::fill(scene.material_of_triangle.begin(), scene.material_of_triangle.end(), 1);
    const SimplifiedModel model =
        simplify_model(scene, {.max_distance = 0.01, .max_object_size = 0.25});
    ASSERT_EQ(model.scene.materials.size(), 3U);
    EXPECT_EQ(model.scene.materials[2].name, "ball, boxes");
    EXPECT_FALSE(model.report.materials[1].has_new_data);
    EXPECT_TRUE(model.report.materials[2].has_new_data);
}

TEST_F(ModelSimplification, NoBoxHoldsAListener) {
    Scene scene = room_with_ball(0.1, 3);
    scene.listeners[0].position = {1.0, 1.0, 1.105};
    const SimplifiedModel model =
        simplify_model(scene, {.max_distance = 0.01, .max_object_size = 0.25});
    EXPECT_TRUE(model.report.objects.empty());
    ASSERT_EQ(model.report.close_emitters.size(), 1U);
    EXPECT_FALSE(model.report.close_emitters[0].is_source);
    EXPECT_NEAR(model.report.close_emitters[0].distance, 0.005, 0.002);
}

TEST_F(ModelSimplification, BoxesMayBeTurnedOff) {
    const Scene scene = room_with_ball(0.02, 3);
    EXPECT_EQ(simplify_model(scene, {.max_distance = 0.02}).report.objects.size(), 1U);
    EXPECT_TRUE(
        simplify_model(scene, {.max_distance = 0.02, .boxes = false}).report.objects.empty());
}

TEST_F(ModelSimplification, KeepsNamesOfMeshes) {
    Scene scene = room_with_ball(0.4, 3);
    std::vector<std::uint32_t> mesh_of_triangle = scene.material_of_triangle;
    scene.mesh.set_meshes({"room", "ball"}, mesh_of_triangle);
    const SimplifiedModel model = simplify_model(scene, {.max_distance = 0.02});
    EXPECT_EQ(model.scene.mesh.mesh_names(), (std::vector<std::string>{"room", "ball"}));
    EXPECT_EQ(model.scene.mesh.mesh_of_triangle(), model.scene.material_of_triangle);
}

TEST_F(ModelSimplification, DoesNotDependOnThreads) {
    const Scene scene = room_with_ball(0.4, 4);
    Executor executor(3);
    const SimplifiedModel one = simplify_model(scene, {.max_distance = 0.02});
    const SimplifiedModel three = simplify_model(scene, {.max_distance = 0.02}, executor);
    EXPECT_EQ(one.scene.mesh.positions_at(0.0), three.scene.mesh.positions_at(0.0));
    EXPECT_EQ(one.scene.mesh.triangles(), three.scene.mesh.triangles());
    EXPECT_EQ(one.report.surfaces.to_original.upper, three.report.surfaces.to_original.upper);
}

TEST_F(ModelSimplification, RefusesScenesThatMoveAndOptionsOutOfRange) {
    const Scene scene = room_with_ball(0.4, 1);
    EXPECT_THROW(simplify_model(scene, {.max_distance = 0.0}), Error);
    EXPECT_THROW(simplify_model(scene, {.max_angle = -1.0}), Error);
    EXPECT_THROW(validate(SimplificationOptions{.max_angle = 3.145}), Error);
    EXPECT_THROW(simplify_model(scene, {.max_object_size = std::nan("")}), Error);
    Scene moving;
    geometry::Node node;
    node.translation.times = {0.0, 1.0};
    node.translation.values = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0};
    geometry::Part part;
    part.node = 0;
    part.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    moving.mesh = geometry::AnimatedMesh({node}, {}, {part}, {{0, 1, 2}});
    moving.materials.emplace_back();
    moving.material_of_triangle = {0};
    EXPECT_THROW(simplify_model(moving), Error);
}

TEST(OptionsForFrequency, AreShareOfItsWavelength) {
    const SimplificationOptions options = options_for_frequency(1000.0, 344.0);
    EXPECT_DOUBLE_EQ(options.max_distance, 0.043);
    EXPECT_DOUBLE_EQ(options.max_object_size, 0.172);
}

TEST(ModelComparison, OfAModelWithItselfIsNoDifference) {
    const Scene scene = room_with_ball(0.4, 1);
    const ModelComparison comparison =
        compare_models(scene, scene, {.specular_order = 1, .rays = 4000});
    ASSERT_EQ(comparison.pairs.size(), 1U);
    EXPECT_EQ(comparison.pairs[0].paths_before, comparison.pairs[0].paths_after);
    EXPECT_GT(comparison.pairs[0].paths_before, 1U);
    for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
        EXPECT_EQ(comparison.pairs[0].before.*kind.value, comparison.pairs[0].after.*kind.value);
    }
}

TEST(NoticeableDifference, CountsByTheMetricsUnits) {
    const auto& t30 = *std::find_if(audio::kBandMetricKinds.begin(),
                                    audio::kBandMetricKinds.end(),
                                    [](const auto& kind) { return kind.key == "t30"; });
    const auto& c80 = *std::find_if(audio::kBandMetricKinds.begin(),
                                    audio::kBandMetricKinds.end(),
                                    [](const auto& kind) { return kind.key == "c80"; });
    audio::BandMetrics before;
    audio::BandMetrics after;
    EXPECT_FALSE(noticeable_difference(t30, before, after));
    before.reverberation_time_t30 = 2.0;
    after.reverberation_time_t30 = 1.9;
    before.clarity_c80_db = -1.0;
    after.clarity_c80_db = 1.5;
    EXPECT_NEAR(*noticeable_difference(t30, before, after), -1.0, 1e-12);
    EXPECT_NEAR(*noticeable_difference(c80, before, after), 2.5, 1e-12);
}

}  // namespace
}  // namespace earshot::propagation
