// SPDX-License-Identifier: MIT
#include "earshot/io/report_map.h"

#include "earshot/geometry/mesh.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

/// STI and C80 at three given points, the last of which is in a wall.
struct Fixture {
    propagation::Scene scene;
    propagation::MetricMap map;

    Fixture() {
        scene.name = "hall.gltf";
        scene.materials = {{.name = "floor"}};
        scene.mesh = geometry::AnimatedMesh::fixed(
            {.positions = {{0, 0, 0}, {2, 0, 0}, {2, 0, 3}}, .triangles = {{0, 1, 2}}});
        scene.material_of_triangle = {0};
        map.metrics = {{"sti", audio::Bands::octaves()}, {"c80:125", audio::Bands::octaves()}};
        map.sources = {"talker"};
        map.source_positions = {{1, 1, 1}};
        for (int i = 0; i < 3; ++i) {
            map.cells.push_back({.cell = {.size = 0}, .point = {1.0 * i, 1.2, 2.0}});
        }
        map.exclusions.assign(3, propagation::PointExclusion::none);
        map.exclusions[2] = propagation::PointExclusion::in_solid;
        map.values = {{.value = 0.5, .standard_error = 0.01},
                      {.value = 3.0, .standard_error = 0.2},
                      {.value = 0.7, .standard_error = 0.01},
                      {.value = 5.0},
                      {},
                      {}};
    }

    Json data() const {
        return Json::parse(
            encode_map_page({.title = "hall",
                             .scene = scene,
                             .bands = audio::Bands::octaves(),
                             .map = map,
                             .limits = {{.metric = 0, .value = 0.6, .is_minimum = true}}}));
    }
};

TEST(MapReport, HoldsValuesWithTheirErrors) {
    const Json data = Fixture().data();
    EXPECT_EQ(data["kind"], "map");
    EXPECT_EQ(data["sources"][0]["position"], Json({1.0, 1.0, 1.0}));
    ASSERT_EQ(data["maps"].size(), 2U);
    const Json& sti = data["maps"][0];
    EXPECT_EQ(sti["metric"], "sti");
    EXPECT_EQ(sti["values"], Json({0.5, 0.7, nullptr}));
    EXPECT_EQ(sti["errors"], Json({0.01, 0.01, nullptr}));
    EXPECT_EQ(sti["points"][1], Json({1.0, 1.2, 2.0}));
    EXPECT_EQ(sti["jnd"], 0.03);
    EXPECT_EQ(sti["plane"]["origin"][1], 1.2);
    EXPECT_EQ(sti["limit"], 0.6);
    EXPECT_EQ(sti["share"], 0.5);  // of the points in the air
    const Json& c80 = data["maps"][1];
    EXPECT_EQ(c80["unit"], "dB");
    EXPECT_FALSE(c80.contains("limit"));
}

TEST(MapReport, AnswersWithTheShareThatMeetsALimit) {
    const Json verdict = Fixture().data()["verdict"];
    ASSERT_EQ(verdict.size(), 3U);
    EXPECT_EQ(verdict[0]["question"], "Is STI at least 0.60?");
    EXPECT_EQ(verdict[0]["answer"], "on 50.0 % of the area; worst 0.50 at (0.00, 1.20, 2.00)");
    EXPECT_EQ(verdict[0]["state"], "missed");
    EXPECT_EQ(verdict[1]["answer"], "0.50 to 0.70, mean 0.60");
    EXPECT_EQ(verdict[2]["question"], "What is C80 at 125 Hz?");
    EXPECT_EQ(verdict[2]["answer"], "3.0 dB to 5.0 dB, mean 4.0 dB");
}

TEST(MapReport, HasTheSameBytesFromRunToRun) {
    EXPECT_EQ(Fixture().data().dump(), Fixture().data().dump());
}

}  // namespace
}  // namespace earshot::io
