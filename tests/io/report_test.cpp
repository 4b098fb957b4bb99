// SPDX-License-Identifier: MIT
#include "earshot/io/report.h"

#include "earshot/geometry/mesh.h"
#include "earshot/io/metrics.h"
#include "earshot/io/results.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base64_text.h"
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace earshot::io {
namespace {

using Json = nlohmann::json;

/// A source and two listeners over a floor of two triangles, with decays of 0.5 s.
struct Fixture {
    propagation::Scene scene;
    std::vector<propagation::PairResult> pairs;
    std::vector<propagation::PairMetrics> metrics;
    RoomReport report;

    Fixture() {
        scene.name = "hall.gltf";
        scene.materials = {{.name = "floor", .absorption = propagation::EnergyCoefficient(0.25)},
                           {.name = "<wall>"}};
        scene.mesh = geometry::AnimatedMesh::fixed(
            {.positions = {{0, 0, 0}, {2, 0, 0}, {2, 0, 3}, {9, 9, 9}, {0, 0, 3}},
             .triangles = {{0, 1, 2}, {0, 2, 4}}});
        scene.material_of_triangle = {0, 1};
        scene.sources = {{.name = "talker", .position = {1, 1, 1}}};
        scene.listeners = {{.name = "front", .position = {1, 1, 2}},
                           {.name = "back", .position = {1, 2, 3}}};
        for (std::size_t listener = 0; listener < 2; ++listener) {
            propagation::PairResult& pair = pairs.emplace_back();
            pair.listener = listener;
            for (int order = 0; order < 3; ++order) {
                propagation::Path path{.order = order, .delay = 0.003 * (1 + order)};
                path.points = {{1, 1, 1}, scene.listeners[listener].position};
                path.pressure.fill(0.1 * (order + 1));
                pair.paths.push_back(path);
            }
            pair.late.bin = 1e-3;
            for (int n = 0; n < 700; ++n) {
                pair.late.energy.emplace_back().fill(0.01 * std::pow(10.0, -6.0 * n * 1e-3 / 0.5));
                pair.late.error.emplace_back().fill(0.001 * std::pow(10.0, -6.0 * n * 1e-3 / 0.5));
            }
            propagation::PairMetrics& told = metrics.emplace_back();
            told.listener = listener;
            for (audio::MetricValues* values :
                 {static_cast<audio::MetricValues*>(&told.expected),
                  &told.expected.standard_error,
                  static_cast<audio::MetricValues*>(&told.response)}) {
                values->bands.resize(10);
            }
            told.expected.bands[4].reverberation_time_t30 = 0.5;
            told.expected.mid.reverberation_time_t30 = 0.5;
            told.expected.speech_transmission_index = listener == 0 ? 0.7 : 0.5;
        }
        const audio::Bands& bands = audio::Bands::octaves();
        report = {
            .title = "hall",
            .metrics = {"metrics.json", encode_metrics({.scene = scene, .bands = bands}, metrics)},
            .paths = {"paths.json", encode_paths(header(), pairs)},
            .histograms = {"histograms.json", encode_histograms(header(), pairs)},
            .scene = &scene,
            .default_materials = {1}};
    }

    ResultHeader header() const {
        return {.scene = scene, .bands = audio::Bands::octaves(), .speed_of_sound = 343.0};
    }

    Json data() const { return Json::parse(encode_room_report(report)); }
};

template <typename Number>
std::vector<Number> numbers(const Json& base64) {
    const std::string bytes = decoded(base64.get<std::string>());
    std::vector<Number> values(bytes.size() / sizeof(Number));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

TEST(RoomReport, HoldsMetricsAndPathsAsTheFilesDo) {
    const Fixture fixture;
    const Json data = fixture.data();
    EXPECT_EQ(data["format"], 1);
    EXPECT_EQ(data["kind"], "rooms");
    EXPECT_EQ(data["bands"].size(), 10U);
    ASSERT_EQ(data["pairs"].size(), 2U);
    const Json metrics = Json::parse(fixture.report.metrics.text);
    const Json paths = Json::parse(fixture.report.paths.text);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(data["pairs"][i]["metrics"], metrics["pairs"][i]);
        EXPECT_EQ(data["pairs"][i]["paths"], paths["pairs"][i]["paths"]);
        EXPECT_EQ(data["pairs"][i]["paths_left_out"], 0);
        EXPECT_EQ(data["pairs"][i]["listener"], i);
    }
    EXPECT_EQ(data["sources"][0]["name"], "talker");
    EXPECT_EQ(data["listeners"][1]["position"], Json({1.0, 2.0, 3.0}));
}

TEST(RoomReport, HoldsTheWallsWithAreasAndCoefficients) {
    const Json data = Fixture().data();
    const auto positions = numbers<float>(data["scene"]["positions_f32"]);
    EXPECT_EQ(positions, (std::vector<float>{0, 0, 0, 2, 0, 0, 2, 0, 3, 0, 0, 3}));
    EXPECT_EQ(numbers<std::uint32_t>(data["scene"]["triangles_u32"]),
              (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(numbers<std::uint16_t>(data["scene"]["material_u16"]),
              (std::vector<std::uint16_t>{0, 1}));
    EXPECT_EQ(data["scene"]["meshes"][0]["triangle_count"], 2);
    EXPECT_EQ(data["materials"][0]["area"], 3.0);
    EXPECT_EQ(data["materials"][0]["absorption"][3], 0.25);
    EXPECT_EQ(data["materials"][0]["guessed"], false);
    EXPECT_EQ(data["materials"][1]["guessed"], true);
    EXPECT_EQ(data["room"]["extent"], Json({2.0, 0.0, 3.0}));
}

// The room decays by 60 dB in 0.5 s, so the line of T30 falls by 30 dB in a quarter of a second.
TEST(RoomReport, HasLinesWhereMetricsAreTold) {
    const Json decay = Fixture().data()["pairs"][0]["decay"];
    EXPECT_EQ(decay["step"], 0.005);
    const Json& line = decay["fits"][4]["t30"];
    const double slope = (line["level_to"].get<double>() - line["level_from"].get<double>()) /
                         (line["to"].get<double>() - line["from"].get<double>());
    EXPECT_NEAR(slope, -120.0, 1.0);
    EXPECT_TRUE(decay["fits"][4]["edt"].is_null());
    EXPECT_TRUE(decay["fits"][3]["t30"].is_null());
    const Json& level = decay["level_db"][4];
    EXPECT_EQ(level[0], 0.0);
    EXPECT_NEAR(level[80].get<double>() - level[40].get<double>(), slope * 0.2, 0.5);
}

TEST(RoomReport, JoinsBinsOfLateEnergyAndTheirErrors) {
    const Json histogram = Fixture().data()["pairs"][0]["histogram"];
    EXPECT_EQ(histogram["step"], 0.005);
    double energy = 0.0;
    double variance = 0.0;
    for (int n = 0; n < 5; ++n) {
        energy += 0.01 * std::pow(10.0, -12.0 * n * 1e-3);
        variance += std::pow(0.001 * std::pow(10.0, -12.0 * n * 1e-3), 2.0);
    }
    EXPECT_NEAR(histogram["energy_db"][2][0].get<double>(), 10.0 * std::log10(energy), 0.006);
    EXPECT_NEAR(
        histogram["relative_error"][2][0].get<double>(), std::sqrt(variance) / energy, 0.0006);
}

TEST(RoomReport, AnswersWithTheWorstSeat) {
    Fixture fixture;
    fixture.report.limits = {parse_report_limit("sti=0.6"), parse_report_limit("t30_mid=0.8")};
    const Json verdict = fixture.data()["verdict"];
    ASSERT_EQ(verdict.size(), 5U);
    EXPECT_EQ(verdict[1]["answer"], "T30 0.50 s at mid frequencies");
    EXPECT_EQ(verdict[2]["answer"],
              "STI 0.50 (G) at the worst of 2 seats (back), 0.70 (B) at the best (front)");
    EXPECT_EQ(verdict[2]["pair"], 1);
    EXPECT_EQ(verdict[3]["question"], "Is STI at least 0.60 everywhere?");
    EXPECT_EQ(verdict[3]["answer"], "0.50 at the worst of 2 seats (back)");
    EXPECT_EQ(verdict[3]["state"], "missed");
    EXPECT_EQ(verdict[4]["state"], "met");
}

/// A sensitivity.json of the pairs: derivatives of STI by absorption are 0.2 and 0.5.
std::string sensitivity_text() {
    const Json bands = std::vector<double>(10, 0.1);
    const Json energy = {{"before_80ms", bands}, {"after_80ms", bands}, {"unknown", 1}};
    const Json derivatives = {{"t30", {bands, bands}},
                              {"c50", {bands, bands}},
                              {"single", {{"sti", {0.2, 0.5}}, {"t30_mid", {-0.5, -1.0}}}}};
    Json file = {{"version", 1},
                 {"bands_hz",
                  std::vector<double>(audio::Bands::octaves().nominal_hz().begin(),
                                      audio::Bands::octaves().nominal_hz().end())},
                 {"materials",
                  {{{"name", "floor"}, {"area", 3.0}, {"absorption", bands}},
                   {{"name", "<wall>"}, {"area", 3.0}, {"absorption", bands}}}}};
    for (const char* const listener : {"front", "back"}) {
        file["pairs"].push_back({{"source", "talker"},
                                 {"listener", listener},
                                 {"time", 0.0},
                                 {"energy", {energy, energy}},
                                 {"derivatives", derivatives},
                                 {"standard_error", nullptr}});
    }
    return file.dump();
}

TEST(RoomReport, NamesTheSurfaceThatRaisesSpeechTransmissionMost) {
    Fixture fixture;
    fixture.report.sensitivity = {"sensitivity.json", sensitivity_text()};
    const Json data = fixture.data();
    ASSERT_EQ(data["sensitivity"]["pairs"].size(), 2U);
    const Json& told = data["sensitivity"]["pairs"][1];
    EXPECT_EQ(told["listener"], 1);
    EXPECT_EQ(told["energy"][0]["before_80ms"][3], 0.1);
    EXPECT_FALSE(told["energy"][0].contains("unknown"));
    EXPECT_EQ(told["derivatives"]["single"]["sti"], Json({0.2, 0.5}));
    EXPECT_FALSE(told["derivatives"].contains("c50"));
    EXPECT_EQ(
        data["verdict"].back()["answer"],
        "<wall>: 0.1 more absorption changes STI at the worst seat (back) by +0.050 and T30 by "
        "-0.10 s; next floor, STI +0.020 (just noticeable: 0.03)");
    EXPECT_EQ(data["verdict"].back()["pair"], 1);
    fixture.report.scene = nullptr;
    EXPECT_EQ(fixture.data()["materials"][1]["name"], "<wall>");
}

TEST(RoomReport, RefusesSensitivitiesOfOtherMaterials) {
    Fixture fixture;
    fixture.report.sensitivity = {"sensitivity.json", sensitivity_text()};
    fixture.scene.materials.emplace_back();
    EXPECT_THROW(fixture.data(), Error);
}

TEST(RoomReport, ComparesPairsOfTheSameNames) {
    Fixture fixture;
    Fixture other;
    other.metrics[1].expected.speech_transmission_index = 0.3;
    other.metrics.erase(other.metrics.begin());
    fixture.report.reference = {
        "folder/before.json",
        encode_metrics({.scene = other.scene, .bands = audio::Bands::octaves()}, other.metrics)};
    fixture.report.reference_name = "before";
    const Json pairs = fixture.data()["pairs"];
    EXPECT_EQ(pairs[1]["reference"]["name"], "before");
    EXPECT_FALSE(pairs[0].contains("reference"));
    EXPECT_EQ(pairs[1]["reference"]["sti"], 0.3);
}

TEST(RoomReport, KeepsTheStrongestPathsInTheirOrder) {
    Fixture fixture;
    propagation::PairResult& pair = fixture.pairs.front();
    const propagation::Path path = pair.paths.front();
    for (std::size_t n = 0; n < kMaxReportPathsOfPair; ++n) {
        pair.paths.push_back(path);
        pair.paths.back().pressure.fill(0.2 + 1e-3 * static_cast<double>(n % 7));
        pair.paths.back().delay = 0.01 + 1e-5 * static_cast<double>(n);
    }
    fixture.report.paths.text = encode_paths(fixture.header(), fixture.pairs);
    const Json told = fixture.data()["pairs"][0];
    ASSERT_EQ(told["paths"].size(), kMaxReportPathsOfPair);
    EXPECT_EQ(told["paths_left_out"], 3);
    // The one of 0.1 is left out and, of 0.2, the last two of many, n = 490 and 497.
    EXPECT_EQ(told["paths"][0]["order"], 1);
    EXPECT_EQ(told["paths"][490]["delay"], 0.01 + 1e-5 * 488);
    EXPECT_EQ(told["paths"][492]["delay"], 0.01 + 1e-5 * 491);
    for (std::size_t i = 1; i < told["paths"].size(); ++i) {
        EXPECT_LE(told["paths"][i - 1]["delay"], told["paths"][i]["delay"]);
    }
}

TEST(RoomReport, HasTheSameBytesFromRunToRun) {
    EXPECT_EQ(encode_room_report(Fixture().report), encode_room_report(Fixture().report));
}

TEST(RoomReport, DigestChangesWithTheScene) {
    const auto digest = [](const Fixture& fixture) {
        return fixture.data()["provenance"]["scene_digest"].get<std::string>();
    };
    Fixture moved;
    moved.scene.listeners[0].position.x += 1e-9;
    Fixture other_material;
    other_material.scene.materials[1].one_sided = true;
    EXPECT_EQ(digest(Fixture()).size(), 64U);
    EXPECT_EQ(digest(Fixture()), digest(Fixture()));
    EXPECT_NE(digest(Fixture()), digest(moved));
    EXPECT_NE(digest(Fixture()), digest(other_material));
}

TEST(RoomReport, LeavesOutWhatNoFileHolds) {
    Fixture fixture;
    fixture.report.scene = nullptr;
    fixture.report.histograms = {};
    fixture.report.metrics = {};
    const Json data = fixture.data();
    EXPECT_FALSE(data.contains("scene") || data.contains("materials"));
    EXPECT_FALSE(data["pairs"][0].contains("decay") || data["pairs"][0].contains("metrics"));
    EXPECT_TRUE(data["verdict"].empty());
    EXPECT_EQ(data["warnings"].size(), 1U);
    EXPECT_TRUE(data["provenance"]["scene_digest"].is_null());
}

TEST(RoomReport, ShowsTheLargestOfTooManyTriangles) {
    Fixture fixture;
    geometry::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {0, 5, 0}};
    mesh.triangles.assign(kMaxReportTriangles, {0, 1, 2});
    mesh.triangles.push_back({0, 3, 4});
    fixture.scene.mesh = geometry::AnimatedMesh::fixed(mesh);
    fixture.scene.material_of_triangle.assign(mesh.triangles.size(), 0);
    const Json data = fixture.data();
    EXPECT_EQ(data["scene"]["left_out"], 1);
    const auto triangles = numbers<std::uint32_t>(data["scene"]["triangles_u32"]);
    ASSERT_EQ(triangles.size(), 3 * kMaxReportTriangles);
    EXPECT_EQ(triangles.back(), 4U);
    EXPECT_NE(data["warnings"][0].get<std::string>().find("200001 triangles"), std::string::npos);
}

TEST(RoomReport, RefusesLimitsOfNoMetric) {
    for (const char* const text : {"sti", "sti=", "sti=x", "loudness=3", "=1", "sti=nan", ""}) {
        EXPECT_THROW(parse_report_limit(text), Error) << text;
    }
}

/// Replaces the first `from` of a text.
std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(RoomReport, RefusesDamagedFilesInOneLine) {
    Fixture good;
    good.report.sensitivity.name = "sensitivity.json";
    const auto expect_refused = [&](ReportFile RoomReport::*file, const std::string& text) {
        RoomReport report = good.report;
        (report.*file).text = text;
        try {
            static_cast<void>(encode_room_report(report));
            ADD_FAILURE() << "accepted: " << text.substr(0, 200);
        } catch (const Error& error) {
            EXPECT_EQ(error.subject(), (good.report.*file).name) << text.substr(0, 200);
            EXPECT_LT(error.line().size(), 400U);
        }
    };
    const std::string& metrics = good.report.metrics.text;
    const std::string& paths = good.report.paths.text;
    const std::string& histograms = good.report.histograms.text;
    for (auto file : {&RoomReport::metrics, &RoomReport::paths, &RoomReport::histograms}) {
        for (const char* const text :
             {" ", "[]", "3", "{", "{}", "{\"pairs\":[]}", "{\"bands_hz\":[1],\"pairs\":[]}"}) {
            expect_refused(file, text);
        }
        expect_refused(file, std::string(1000, '['));
        const std::string& text = (good.report.*file).text;
        expect_refused(file, text.substr(0, text.size() / 2));
        expect_refused(file, with(text, "\"talker\"", "7"));
        expect_refused(file, with(text, "\"time\":0.0", "\"time\":\"0\""));
        expect_refused(file, with(text, "31.5", "31.6"));
    }
    const std::string sensitivity = sensitivity_text();
    for (const auto& [from, to] : {std::pair{"\"materials\":[", "\"materials\":[3,"},
                                   {"\"materials\":[{", "\"materials\":[{\"name\":3},{"},
                                   {"\"energy\":[", "\"energy\":[1,"},
                                   {"\"derivatives\"", "\"derivations\""}}) {
        expect_refused(&RoomReport::sensitivity, with(sensitivity, from, to));
    }
    expect_refused(&RoomReport::metrics, with(metrics, "\"pairs\":[", "\"pairs\":[3,"));
    expect_refused(&RoomReport::paths, with(paths, "\"delay\":0.003", "\"delay\":1e300"));
    expect_refused(&RoomReport::paths, with(paths, "\"delay\":0.003", "\"delay\":-1"));
    expect_refused(&RoomReport::paths, with(paths, "\"points\":[[", "\"points\":[[1,"));
    expect_refused(&RoomReport::paths, with(paths, "\"points\":[[", "\"points\":[\"a\",["));
    expect_refused(&RoomReport::paths, with(paths, "\"pressure\":[", "\"pressure\":[1,"));
    expect_refused(&RoomReport::paths, with(paths, "\"pressure\":[", "\"pressure\":[1e9,"));
    expect_refused(&RoomReport::histograms, with(histograms, "\"bin\":0.001", "\"bin\":0"));
    expect_refused(&RoomReport::histograms, with(histograms, "\"bin\":0.001", "\"bin\":1"));
    expect_refused(&RoomReport::histograms, with(histograms, "\"energy\":[", "\"energy\":[[1],"));
    expect_refused(&RoomReport::histograms, with(histograms, "0.01,", "-0.01,"));
    expect_refused(&RoomReport::histograms, with(histograms, "0.01,", ""));
}

}  // namespace
}  // namespace earshot::io
