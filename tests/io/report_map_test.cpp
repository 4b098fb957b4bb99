// SPDX-License-Identifier: MIT
#include "earshot/io/report_map.h"

#include "earshot/geometry/mesh.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

/// STI and T30 at two points, one of which has no T30.
Json map_file() {
    const Json points = {{0.0, 1.2, 2.0}, {1.0, 1.2, 2.0}};
    const Json plane = {{"origin", {0, 1.2, 0}}, {"u", {1, 0, 0}}, {"v", {0, 0, 1}}};
    return {{"version", 1},
            {"scene", "hall.gltf"},
            {"time", 0.0},
            {"sources", {{{"name", "<talker>"}, {"position", {1.0, 1.0, 1.0}}}}},
            {"maps",
             {{{"metric", "sti"},
               {"unit", ""},
               {"source", 0},
               {"jnd", 0.03},
               {"jnd_is_relative", false},
               {"limit", 0.6},
               {"limit_is_minimum", true},
               {"share", 0.25},
               {"plane", plane},
               {"points", points},
               {"values", {0.5, 0.7}},
               {"errors", {0.01, nullptr}},
               {"cells", {{0, 0, 1, 1, 0.5}, {1, 0, 2, 1, 0.7}}},
               {"contour", Json::array()}},
              {{"metric", "t30:125"},
               {"unit", "s"},
               {"source", 0},
               {"jnd", 0.05},
               {"jnd_is_relative", true},
               {"limit", nullptr},
               {"share", nullptr},
               {"plane", plane},
               {"points", points},
               {"values", {2.0, nullptr}},
               {"errors", {0.1, nullptr}},
               {"cells", Json::array()},
               {"contour", Json::array()}}}}};
}

MapPage page_of(const Json& file) {
    return {.title = "hall", .map = {"map.json", file.dump()}};
}

TEST(MapReport, HoldsTheMapsOfTheFile) {
    const Json data = Json::parse(encode_map_page(page_of(map_file())));
    EXPECT_EQ(data["kind"], "map");
    EXPECT_EQ(data["sources"], map_file()["sources"]);
    ASSERT_EQ(data["maps"].size(), 2U);
    Json sti = map_file()["maps"][0];
    EXPECT_EQ(data["maps"][0], sti);
    EXPECT_EQ(data["maps"][1]["jnd"], 0.1);  // of 2 s
    EXPECT_EQ(data["maps"][1]["values"], map_file()["maps"][1]["values"]);
    EXPECT_FALSE(data.contains("scene"));
}

TEST(MapReport, AnswersWithTheShareThatMeetsALimit) {
    MapPage page = page_of(map_file());
    const Json verdict = Json::parse(encode_map_page(page))["verdict"];
    ASSERT_EQ(verdict.size(), 3U);
    EXPECT_EQ(verdict[0]["question"], "Is STI at least 0.60?");
    EXPECT_EQ(verdict[0]["answer"], "on 25.0 % of the area; worst 0.50");
    EXPECT_EQ(verdict[0]["state"], "missed");
    EXPECT_EQ(verdict[1]["answer"], "0.50 to 0.70, mean of the points 0.60");
    EXPECT_EQ(verdict[2]["question"], "What is T30 at 125 Hz?");
    EXPECT_EQ(verdict[2]["answer"], "2.00 s to 2.00 s, mean of the points 2.00 s");
    page.min_share = 0.2;
    EXPECT_EQ(Json::parse(encode_map_page(page))["verdict"][0]["state"], "met");
}

TEST(MapReport, ShowsTheWallsOfTheScene) {
    propagation::Scene scene;
    scene.materials = {{.name = "floor"}};
    scene.mesh = geometry::AnimatedMesh::fixed(
        {.positions = {{0, 0, 0}, {2, 0, 0}, {2, 0, 3}}, .triangles = {{0, 1, 2}}});
    scene.material_of_triangle = {0};
    MapPage page = page_of(map_file());
    page.scene = &scene;
    const Json data = Json::parse(encode_map_page(page));
    EXPECT_EQ(data["room"]["extent"], Json({2.0, 0.0, 3.0}));
    EXPECT_EQ(data["materials"][0]["area"], 3.0);
    EXPECT_TRUE(data["scene"].contains("positions_f32"));
    EXPECT_EQ(data["provenance"]["scene_digest"].get<std::string>().size(), 64U);
}

TEST(MapReport, RefusesDamagedFiles) {
    const auto expect_refused = [](const std::string& text) {
        try {
            static_cast<void>(encode_map_page({.map = {"map.json", text}}));
            ADD_FAILURE() << "accepted: " << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.subject(), "map.json");
        }
    };
    for (const char* const text : {"", "[]", "{}", "{\"sources\":[],\"time\":0}"}) {
        expect_refused(text);
    }
    for (const auto& [key, value] : {std::pair<const char*, Json>{"values", {1.0}},
                                     {"values", "no"},
                                     {"values", {"a", "b"}},
                                     {"errors", Json::array()},
                                     {"points", {{1, 2, 3}, {1, 2}}},
                                     {"cells", {{1, 2}}},
                                     {"source", 1},
                                     {"source", "talker"},
                                     {"source", 0.5},
                                     {"source", -1e300},
                                     {"metric", nullptr},
                                     {"share", "all"}}) {
        Json file = map_file();
        file["maps"][0][key] = value;
        expect_refused(file.dump());
    }
}

}  // namespace
}  // namespace earshot::io
