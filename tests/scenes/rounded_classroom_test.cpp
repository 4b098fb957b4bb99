// SPDX-License-Identifier: MIT
#include "earshot/geometry/clean.h"
#include "earshot/geometry/simplify.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/model_comparison.h"
#include "earshot/propagation/model_simplification.h"
#include "earshot/scenes/gltf_writer.h"
#include "earshot/scenes/models.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <algorithm>
#include <cmath>

namespace earshot::scenes {
namespace {

propagation::Scene load_rounded(int pieces) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "classroom.glb";
    io::write_whole_file(file,
                         write_gltf(make_classroom({.rounding = pieces}), GltfForm::binary).bytes);
    return io::load_scene(file).scene;
}

TEST(RoundedClassroom, HasClosedFurnitureOfTensOfThousandsOfTriangles) {
    const propagation::Scene scene = load_rounded(6);
    const std::vector<geometry::Vec3> positions = scene.mesh.positions_at(0.0);
    EXPECT_GT(scene.mesh.triangles().size(), 60000U);
    const geometry::CleanReport report =
        geometry::clean({positions, scene.mesh.triangles()}).report;
    EXPECT_EQ(report.open_edges, 0U);
    EXPECT_EQ(report.non_manifold_edges, 0U);
    EXPECT_EQ(report.degenerate_triangles, 0U);
}

const audio::BandMetricKind& kind_of(const char* key) {
    return *std::find_if(audio::kBandMetricKinds.begin(),
                         audio::kBandMetricKinds.end(),
                         [&](const audio::BandMetricKind& kind) { return kind.key == key; });
}

// What simplification is for: the furniture of a CAD export costs most of the time and changes
// nothing that is heard.
TEST(SlowRoundedClassroom, SoundsTheSameSimplifiedInATenthOfTheTime) {
    if (!geometry::simplify_available()) {
        GTEST_SKIP() << "built without OpenMesh";
    }
    const propagation::Scene scene = load_rounded(6);
    const propagation::SimplifiedModel model =
        propagation::simplify_model(scene, {.max_distance = 0.01});
    EXPECT_LT(model.report.triangles_after, 3000U);
    EXPECT_LE(model.report.surfaces.upper(), 0.01);
    EXPECT_NEAR(model.report.solid_volume_after,
                model.report.solid_volume_before,
                0.02 * model.report.solid_volume_before);
    const propagation::ModelComparison comparison = propagation::compare_models(
        scene, model.scene, {.specular_order = 3, .rays = 400000, .max_error = 0.02});
    ASSERT_EQ(comparison.pairs.size(), 3U);
    for (const propagation::PairComparison& pair : comparison.pairs) {
        for (const char* key : {"t30", "c80"}) {
            const auto difference =
                propagation::noticeable_difference(kind_of(key), pair.before, pair.after);
            ASSERT_TRUE(difference) << key;
            EXPECT_LT(std::abs(*difference), 1.0) << key << ", listener " << pair.listener;
        }
    }
    EXPECT_GT(comparison.path_seconds_before, 10.0 * comparison.path_seconds_after);
}

}  // namespace
}  // namespace earshot::scenes
