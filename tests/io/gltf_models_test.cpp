// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/gltf_oracle.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cmath>

namespace earshot::io {
namespace {

struct Model {
    const char* name;
    std::size_t triangles;
    std::size_t animations;
};

void PrintTo(const Model& model, std::ostream* stream) {
    *stream << model.name;
}

class ReferenceModel : public testing::TestWithParam<Model> {};

/// Largest difference of a coordinate. A triangle may be turned over where its node mirrors it.
double largest_difference(const std::vector<geometry::Vec3>& positions,
                          const std::vector<geometry::Triangle>& triangles,
                          const std::vector<test::Point>& want) {
    double largest = 0.0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto difference = [&](std::size_t second, std::size_t third) {
            double most = 0.0;
            const std::array<std::size_t, 3> order{0, second, third};
            for (std::size_t k = 0; k < 3; ++k) {
                for (int axis = 0; axis < 3; ++axis) {
                    most =
                        std::max(most,
                                 std::abs(positions[triangles[i][k]][axis] -
                                          want[3 * i + order[k]][static_cast<std::size_t>(axis)]));
                }
            }
            return most;
        };
        largest = std::max(largest, std::min(difference(1, 2), difference(2, 1)));
    }
    return largest;
}

double extent(const std::vector<test::Point>& points) {
    double largest = 0.0;
    for (const test::Point& point : points) {
        for (const double x : point) {
            largest = std::max(largest, std::abs(x));
        }
    }
    return largest;
}

TEST_P(ReferenceModel, AgreesWithAnIndependentEvaluationAtEveryTime) {
    const Model& model = GetParam();
    const auto file = test::shared_file("models") / model.name;
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "reference model " << model.name << " is not here";
    }
    // Both sides round differently along chains of some ten matrices with inverse bind matrices in
    // between, whose terms can be some hundred times larger than the result.
    constexpr double kRelative = 1e4 * std::numeric_limits<double>::epsilon();
    for (std::size_t animation = 0; animation < model.animations; ++animation) {
        const LoadedScene loaded = load_scene(file, {.animation = std::to_string(animation)});
        const geometry::AnimatedMesh& mesh = loaded.scene.mesh;
        ASSERT_EQ(mesh.triangles().size(), model.triangles);
        ASSERT_GT(mesh.duration(), 0.0);
        std::vector<double> times;
        for (const double share : {0.0, 0.123, 0.5, 0.77, 1.0}) {
            times.push_back(share * mesh.duration());
        }
        const auto frames = test::evaluate_gltf(file, animation, times);
        for (std::size_t i = 0; i < times.size(); ++i) {
            ASSERT_EQ(frames[i].size(), 3 * model.triangles);
            EXPECT_LE(largest_difference(mesh.positions_at(times[i]), mesh.triangles(), frames[i]),
                      kRelative * extent(frames[i]))
                << "animation " << animation << " at " << times[i] << " s";
        }
    }
}

TEST_P(ReferenceModel, Moves) {
    const Model& model = GetParam();
    const auto file = test::shared_file("models") / model.name;
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "reference model " << model.name << " is not here";
    }
    const LoadedScene loaded = load_scene(file);
    const geometry::AnimatedMesh& mesh = loaded.scene.mesh;
    EXPECT_NE(mesh.positions_at(0.0), mesh.positions_at(0.4 * mesh.duration()));
}

INSTANTIATE_TEST_SUITE_P(GltfModels,
                         ReferenceModel,
                         testing::Values(Model{"Fox.glb", 576, 3},
                                         Model{"CesiumMan.glb", 4672, 1},
                                         Model{"MorphStressTest.gltf", 2412, 3},
                                         Model{"robot.glb", 3238, 14}));

}  // namespace
}  // namespace earshot::io
