// SPDX-License-Identifier: MIT
#include "earshot/io/results.h"

#include "earshot/io/wav.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

struct Fixture {
    propagation::Scene scene;
    const audio::Bands& bands = audio::Bands::octaves();
    ResultHeader header{.scene = scene, .bands = bands, .speed_of_sound = 343.2};

    Fixture() {
        scene.name = "a \"b\".gltf";
        scene.materials.resize(2);
        scene.materials[1].name = "br\xffick";  // not UTF-8
        scene.sources = {{.name = "s", .node = -1, .position = {}}};
        scene.listeners = {{.name = "l", .node = -1, .position = {}}};
    }
};

TEST(EncodePaths, NumbersReadBackAsTheSameDoubles) {
    const Fixture fixture;
    propagation::Path path;
    path.kind = propagation::PathKind::specular;
    path.order = 1;
    path.length = 0.1 + 0.2;
    path.delay = 1.0 / 3.0;
    path.points = {{0.1, 1e-300, -0.0}, {1e22, 2, 3}, {4, 5, 6}};
    path.triangles = {4000000000U};
    path.materials = {1};
    path.pressure[9] = 5e-324;
    const std::string text =
        encode_paths(fixture.header,
                     {{.source = 0, .listener = 0, .time = 0.1, .paths = {path}}},
                     std::vector<propagation::Pose>{{.front = {0.6, 0.0, 0.8}}});
    const Json json = Json::parse(text);
    EXPECT_EQ(json["version"], 1);
    EXPECT_EQ(json["scene"], "a \"b\".gltf");
    EXPECT_EQ(json["bands_hz"][0], 31.5);
    const Json& read = json["pairs"][0]["paths"][0];
    EXPECT_EQ(json["pairs"][0]["time"], 0.1);
    EXPECT_EQ(json["pairs"][0]["listener_front"], Json::array({0.6, 0.0, 0.8}));
    EXPECT_EQ(json["pairs"][0]["listener_up"], Json::array({0.0, 1.0, 0.0}));
    EXPECT_EQ(read["length"].get<double>(), path.length);
    EXPECT_EQ(read["delay"].get<double>(), path.delay);
    EXPECT_EQ(read["points"][0][1].get<double>(), 1e-300);
    EXPECT_EQ(read["points"][1][0].get<double>(), 1e22);
    EXPECT_EQ(read["triangles"][0], 4000000000U);
    EXPECT_EQ(read["pressure"].size(), 10U);
    EXPECT_EQ(read["pressure"][9].get<double>(), 5e-324);
    EXPECT_EQ(read["materials"][0], "br\xef\xbf\xbdick");
}

TEST(EncodeHistograms, HoldEnergiesAndErrorsBandByBand) {
    const Fixture fixture;
    propagation::PairResult pair;
    pair.late.bin = 0.002;
    pair.late.energy.resize(3);
    pair.late.error.resize(3);
    pair.late.energy[2][9] = 0.1 + 0.2;
    pair.late.error[1][0] = 1.0 / 3.0;
    const Json json = Json::parse(encode_histograms(fixture.header, {pair, {}}));
    EXPECT_EQ(json["version"], 1);
    EXPECT_EQ(json["bands_hz"].size(), 10U);
    const Json& read = json["pairs"][0];
    EXPECT_EQ(read["source"], "s");
    EXPECT_EQ(read["bin"], 0.002);
    ASSERT_EQ(read["energy"].size(), 10U);
    ASSERT_EQ(read["energy"][9].size(), 3U);
    EXPECT_EQ(read["energy"][9][2].get<double>(), 0.1 + 0.2);
    EXPECT_EQ(read["error"][0][1].get<double>(), 1.0 / 3.0);
    EXPECT_EQ(json["pairs"][1]["energy"][0], Json::array());
}

TEST(EncodePaths, APairWithoutPathsHasAnEmptyList) {
    const Fixture fixture;
    const Json json = Json::parse(encode_paths(fixture.header, {{}}));
    EXPECT_EQ(json["pairs"][0]["paths"], Json::array());
}

TEST(Results, ResponsesAreWavFilesOfInterleavedChannels) {
    const std::vector<audio::ImpulseResponse> channels = {{8000.0, {0.5, -0.25}},
                                                          {8000.0, {1.0, 0.125}}};
    EXPECT_EQ(
        encode_response(channels),
        encode_wav({.sample_rate = 8000.0, .channels = 2, .samples = {0.5, 1.0, -0.25, 0.125}}));
}

}  // namespace
}  // namespace earshot::io
