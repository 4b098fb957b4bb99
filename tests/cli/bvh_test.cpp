// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

const std::string kScenes = test::source_file("scenes/").string();

Json json_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "bvh");
    arguments.emplace_back("--json");
    const RunResult result = run_earshot(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return Json::parse(result.out);
}

/// What does not depend on the clock.
Json without_times(Json report) {
    report.erase("build_seconds");
    report.erase("refit_seconds");
    for (Json& frame : report["frames"]) {
        frame.erase("build_seconds");
        frame.erase("refit_seconds");
        frame.erase("update_seconds");
    }
    return report;
}

TEST(Bvh, JsonCountsTheHierarchy) {
    const Json report = json_of({kScenes + "shoebox.gltf"});
    EXPECT_EQ(report.at("version"), 1);
    EXPECT_EQ(report.at("scene"), "shoebox.gltf");
    EXPECT_EQ(report.at("triangles"), 12);
    const int leaves = report.at("leaves");
    EXPECT_EQ(report.at("nodes"), 2 * leaves - 1);  // a binary tree
    EXPECT_EQ(report.at("bytes"), 32 * (2 * leaves - 1) + 4 * 12);
    EXPECT_GE(report.at("depth"), 2);  // 12 triangles, at most 4 to a leaf
    EXPECT_GT(report.at("wide_bytes"), report.at("quantised_bytes"));
    EXPECT_GT(report.at("quantised_bytes"), 0);
    EXPECT_GT(report.at("sah_cost"), 0.0);
    EXPECT_GT(report.at("build_seconds"), 0.0);
    EXPECT_GT(report.at("refit_seconds"), 0.0);
    EXPECT_FALSE(report.contains("frames"));
}

TEST(Bvh, UpdatedTreesOfWalksAreNeverWorseThanRefittedOnes) {
    for (const char* model : {"robot.glb", "CesiumMan.glb"}) {
        const std::filesystem::path path = test::shared_file("models") / model;
        if (!std::filesystem::exists(path)) {
            GTEST_SKIP() << "third-party mesh absent: " << path;
        }
        const Json report = json_of({path.string(), "--frames", "0:4:0.04"});
        for (const Json& frame : report.at("frames")) {
            EXPECT_LE(frame.at("update_steps").get<double>(),
                      1.03 * frame.at("refit_steps").get<double>())
                << model << " at " << frame.at("time");
        }
    }
}

TEST(Bvh, FramesFollowTheAnimation) {
    const Json report = json_of({kScenes + "door.gltf", "--frames", "0:1:0.5"});
    ASSERT_EQ(report.at("frames").size(), 3U);
    double time = 0.0;
    for (const Json& frame : report["frames"]) {
        EXPECT_EQ(frame.at("time"), time);
        EXPECT_GT(frame.at("sah_cost"), 0.0);
        EXPECT_GT(frame.at("rebuilt_sah_cost"), 0.0);
        EXPECT_GT(frame.at("refit_seconds"), 0.0);
        EXPECT_GT(frame.at("build_seconds"), 0.0);
        EXPECT_GT(frame.at("refit_steps"), 1.0);
        EXPECT_GT(frame.at("rebuild_steps"), 1.0);
        EXPECT_GT(frame.at("update_steps"), 1.0);
        const std::string action = frame.at("action");
        EXPECT_TRUE(action == "refit" || action == "repair" || action == "rebuild") << action;
        time += 0.5;
    }
    EXPECT_EQ(report["frames"][0]["sah_cost"], report["sah_cost"]);
}

TEST(Bvh, TreesDoNotDependOnTheNumberOfThreads) {
    const std::vector<std::string> line = {kScenes + "door.gltf", "--frames", "0:1:0.25"};
    std::vector<std::string> one = line, three = line;
    one.insert(one.end(), {"--threads", "1"});
    three.insert(three.end(), {"--threads", "3"});
    EXPECT_EQ(without_times(json_of(one)), without_times(json_of(three)));
}

TEST(Bvh, TableHasALinePerQuantityAndFrame) {
    const RunResult result = run_earshot({"bvh", kScenes + "door.gltf", "--frames", "0:1:0.5"});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "");
    for (const char* label : {"triangles ",
                              "nodes ",
                              "depth ",
                              "SAH cost ",
                              "memory ",
                              "for rays ",
                              "quantised ",
                              "build "}) {
        EXPECT_NE(result.out.find(label), std::string::npos) << label;
    }
    std::istringstream lines(result.out.substr(result.out.find("time s")));
    std::string line;
    std::getline(lines, line);
    int frames = 0;
    while (std::getline(lines, line)) {
        ++frames;
    }
    EXPECT_EQ(frames, 3);
    EXPECT_EQ(run_earshot({"bvh", kScenes + "door.gltf", "--quiet"}).out, "");
}

TEST(Bvh, PlotsTheFrames) {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "frames.svg").string();
    const RunResult result =
        run_earshot({"bvh", kScenes + "door.gltf", "--frames", "0:1:0.25", "--plot", file});
    EXPECT_EQ(result.status, 0) << result.err;
    std::ifstream stream(file);
    const std::string svg{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(svg.rfind("<svg", 0), 0U);
    EXPECT_NE(svg.find("rebuild always"), std::string::npos);
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    EXPECT_TRUE(
        failed_with(run_earshot({"bvh", kScenes + "door.gltf", "--plot", file}), 2, "--frames"));
    EXPECT_TRUE(failed_with(run_earshot({"bvh",
                                         kScenes + "door.gltf",
                                         "--frames",
                                         "0:1:0.5",
                                         "--plot",
                                         "/no/such/folder/x.svg"}),
                            1,
                            "/no/such/folder"));
}

TEST(Bvh, BuildersMakeTreesOfTheirOwn) {
    const std::string scene = kScenes + "door.gltf";
    const Json usual = without_times(json_of({scene}));
    EXPECT_EQ(without_times(json_of({scene, "--builder", "binned_sah"})), usual);
    EXPECT_NE(without_times(json_of({scene, "--builder", "spatial_median"})), usual);
    EXPECT_NE(run_earshot({"bvh", "--help"}).out.find("\n  sweep_sah "), std::string::npos);
}

TEST(Bvh, ErrorsSayWhatIsWrong) {
    EXPECT_TRUE(
        failed_with(run_earshot({"bvh", kScenes + "door.gltf", "--builder", "magic"}), 2, "magic"));
    EXPECT_TRUE(failed_with(run_earshot({"bvh"}), 2, "SCENE"));
    EXPECT_TRUE(failed_with(run_earshot({"bvh", "missing.gltf"}), 1, "missing.gltf"));
    EXPECT_TRUE(failed_with(
        run_earshot({"bvh", kScenes + "door.gltf", "--frames", "1:0:1"}), 2, "A:B:STEP"));
    EXPECT_TRUE(
        failed_with(run_earshot({"bvh", kScenes + "door.gltf", "--frames", "0:1:1", "--time", "1"}),
                    2,
                    "--time"));
}

}  // namespace
}  // namespace earshot::test
