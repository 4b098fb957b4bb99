// SPDX-License-Identifier: MIT

#include "earshot/geometry/mesh_topology.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

/// A room of 6 x 3 x 4 with a cupboard, in quadrilaterals of an OBJ file.
struct House {
    double scale = 1.0;
    bool room_is_turned = false;
    bool doubled = false;
    bool cupboard_is_turned = false;
    bool has_neighbour = false;  ///< a room of 3 x 3 x 4 behind a wall

    std::string obj() const {
        std::ostringstream text;
        text.precision(17);
        unsigned corners = 0;
        const auto box = [&](std::array<double, 3> low, std::array<double, 3> high, bool inward) {
            for (unsigned corner = 0; corner < 8; ++corner) {
                text << "v " << scale * ((corner & 1U) != 0 ? high[0] : low[0]) << ' '
                     << scale * ((corner & 2U) != 0 ? high[1] : low[1]) << ' '
                     << scale * ((corner & 4U) != 0 ? high[2] : low[2]) << '\n';
            }
            constexpr std::array<std::array<unsigned, 4>, 6> kSides{{{0, 1, 3, 2},
                                                                     {4, 6, 7, 5},
                                                                     {0, 4, 5, 1},
                                                                     {2, 3, 7, 6},
                                                                     {0, 2, 6, 4},
                                                                     {1, 5, 7, 3}}};
            for (const auto& side : kSides) {
                text << 'f';
                for (unsigned k = 0; k < 4; ++k) {
                    text << ' ' << corners + side[inward ? k : (4 - k) % 4] + 1;
                }
                text << '\n';
            }
            corners += 8;
        };
        box({0, 0, 0}, {6, 3, 4}, !room_is_turned);
        box({1, 0.5, 1}, {2, 2, 1.5}, cupboard_is_turned);
        if (doubled) {
            box({0, 0, 0}, {6, 3, 4}, false);
        }
        if (has_neighbour) {
            box({6.2, 0, 0}, {9.2, 3, 4}, true);
            box({-0.2, -0.2, -0.2}, {9.4, 3.2, 4.2}, false);
        }
        return text.str();
    }
};

class Check : public testing::Test {
protected:
    void SetUp() override {
        if (!geometry::topology_available()) {
            GTEST_SKIP() << "this build is without OpenMesh";
        }
    }

    RunResult check(const House& house, std::vector<std::string> options) {
        options.insert(options.begin(), folder_.file("house.obj", house.obj()).string());
        return check_file(std::move(options));
    }

    static RunResult check_file(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "check");
        arguments.insert(arguments.end(), {"--forecast", "0"});
        return run_earshot(std::move(arguments));
    }

    /// Whether a part stands in the first ten lines.
    static bool begins_with(const RunResult& result, const std::string& part) {
        std::size_t end = 0;
        for (int line = 0; line < 10 && end != std::string::npos; ++line) {
            end = result.out.find('\n', end + 1);
        }
        return result.out.substr(0, end).find(part) != std::string::npos;
    }

    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    const TemporaryFolder folder_;
};

const std::vector<std::string> kPlaced = {"--source", "4,1,1", "--listener", "5,2,3"};

TEST_F(Check, ProjectScenesAreClean) {
    const RunResult result = check_file({source_file("scenes/coupled_rooms.gltf").string()});
    EXPECT_EQ(result.status, 0) << result.out << result.err;
    EXPECT_TRUE(result.out.starts_with("coupled_rooms.gltf: clean")) << result.out;
}

TEST_F(Check, TheFirstTenLinesTellWhatIsWrong) {
    std::vector<std::string> options = {"--source", "1.5,1,1.2", "--listener", "5,2,3"};
    RunResult result = check({}, options);
    EXPECT_EQ(result.status, 1) << result.out;
    EXPECT_TRUE(begins_with(result, "is inside a solid")) << result.out;

    result = check({}, {"--source", "4,1,1", "--listener", "5,2,9"});
    EXPECT_EQ(result.status, 1) << result.out;
    EXPECT_TRUE(begins_with(result, "is outside of the room")) << result.out;

    result = check({.has_neighbour = true}, {"--source", "4,1,1", "--listener", "8,1,3"});
    EXPECT_EQ(result.status, 1) << result.out;
    EXPECT_TRUE(begins_with(result, "is in a sealed room: no source shares its air")) << result.out;

    result = check({.cupboard_is_turned = true}, kPlaced);
    EXPECT_EQ(result.status, 3) << result.out;
    EXPECT_TRUE(begins_with(result, "12 faces are reversed")) << result.out;

    result = check({.room_is_turned = true}, kPlaced);
    EXPECT_EQ(result.status, 3) << result.out;
    EXPECT_TRUE(begins_with(result, "inside out")) << result.out;

    result = check({.doubled = true}, kPlaced);
    EXPECT_EQ(result.status, 3) << result.out;
    EXPECT_TRUE(begins_with(result, "12 faces are doubled (12 reversed)")) << result.out;

    result = check({.scale = 1.0 / 0.0254}, {});
    EXPECT_EQ(result.status, 3) << result.out;
    EXPECT_TRUE(begins_with(result, "--units in makes it 6 x 3 x 4 m")) << result.out;
    EXPECT_TRUE(begins_with(result, "no acoustic data")) << result.out;
}

TEST_F(Check, JsonHoldsTheContractsKeys) {
    const RunResult result = check({}, {"--json", "--material", "*=brick-painted"});
    ASSERT_EQ(result.status, 0) << result.err << result.out;
    const Json report = Json::parse(result.out);
    for (const char* key : {"version",
                            "scene",
                            "extent",
                            "units",
                            "volume",
                            "surface",
                            "leaks",
                            "holes",
                            "in_solid",
                            "outside",
                            "reversed",
                            "doubled",
                            "unreached_triangles",
                            "materials",
                            "seconds"}) {
        EXPECT_TRUE(report.contains(key)) << key;
    }
    EXPECT_EQ(report["version"], 1);
    EXPECT_EQ(report["extent"], Json({6.0, 3.0, 4.0}));
    EXPECT_EQ(report["units"]["taken"], "m");
    EXPECT_TRUE(report["units"]["proposed"].is_null());
    EXPECT_NEAR(report["volume"].get<double>(), 72.0 - 0.75, 1e-9);
    EXPECT_TRUE(report["leaks"].empty());
    EXPECT_EQ(report["materials"][0]["area"].get<double>(), 108.0 + 5.5);
}

TEST_F(Check, FixMendsACopyAndLeavesTheModel) {
    const House house{.room_is_turned = true, .doubled = true};
    const std::string before = house.obj();
    std::vector<std::string> options = kPlaced;
    options.insert(options.end(),
                   {"--fix", "-o", path("mended.glb"), "--material", "*=brick-painted"});
    options.insert(options.end(), {"--image", path("plan.svg")});
    RunResult result = check(house, options);
    EXPECT_EQ(result.status, 3);
    EXPECT_NE(result.out.find("removed as doubled: triangles 24-35"), std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find("12 turned to the air: triangles 0-11"), std::string::npos)
        << result.out;
    std::ifstream input(path("house.obj"));
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(input), {}), before);
    std::ifstream picture(path("plan.svg"));
    EXPECT_NE(std::string(std::istreambuf_iterator<char>(picture), {}).find("</svg>"),
              std::string::npos);

    result = check_file({path("mended.glb"), "--json"});
    EXPECT_EQ(result.status, 0) << result.out << result.err;
    const Json report = Json::parse(result.out);
    EXPECT_TRUE(report["doubled"].empty());
    EXPECT_TRUE(report["reversed"].empty());
    EXPECT_EQ(report["airs"].size(), 1U);
    EXPECT_EQ(report["airs"][0]["sources"].size(), 1U);
    EXPECT_NEAR(report["volume"].get<double>(), 72.0 - 0.75, 1e-9);
}

TEST_F(Check, FixNeedsAnotherFileAndAModelAtRest) {
    const RunResult alone = check({}, {"--fix"});
    EXPECT_EQ(alone.status, 2) << alone.err;
    const auto scene = source_file("scenes/door.gltf").string();
    const RunResult moving = check_file({scene, "--fix", "-o", path("door.glb")});
    EXPECT_TRUE(failed_with(moving, 1, "moves"));
    EXPECT_FALSE(std::filesystem::exists(path("door.glb")));
    const RunResult frozen = check_file({scene, "--fix", "-o", path("door.glb"), "--time", "1"});
    EXPECT_EQ(frozen.status, 0) << frozen.err;
    EXPECT_EQ(check_file({path("door.glb")}).status, 0);
    const std::string file = folder_.file("house.obj", House{}.obj()).string();
    const RunResult itself = check_file({file, "--fix", "-o", file});
    EXPECT_TRUE(failed_with(itself, 1, "is the model itself"));
}

TEST_F(Check, WhatIsNoMeshIsToldInOneLine) {
    const auto fails = [&](const char* name, const std::string& text, const std::string& problem) {
        const RunResult result = check_file({folder_.file(name, text).string()});
        EXPECT_TRUE(failed_with(result, 1, problem)) << name << result.status << result.err;
    };
    fails("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "broken.ply");
    fails("broken.gltf", "{\"asset\":", "broken.gltf");
    fails("empty.obj", "", "empty.obj");
    fails("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "nan.obj");
    fails("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangle has an area");
    const RunResult two = check_file(
        {folder_.file("two.obj", "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nf 1 2 3 4\n").string()});
    EXPECT_EQ(two.status, 3) << two.out << two.err;
}

TEST_F(Check, MeshesOfAllKindsDoNotCrash) {
    const auto models = shared_file("models");
    if (!std::filesystem::exists(models)) {
        GTEST_SKIP() << "the third-party meshes are absent";
    }
    // Larger ones are in SlowMeshesDoNotCrash.
    for (const char* name : {"Fox.glb", "CesiumMan.glb", "MorphStressTest.gltf", "robot.glb"}) {
        const RunResult result = check_file({(models / name).string(), "--quiet"});
        EXPECT_TRUE(result.status == 0 || result.status == 1 || result.status == 3)
            << name << result.status << result.err;
    }
}

TEST_F(Check, SlowMeshesDoNotCrash) {
    const auto shared = shared_file("");
    if (!std::filesystem::exists(shared)) {
        GTEST_SKIP() << "the third-party meshes are absent";
    }
    constexpr std::array<std::string_view, 6> kSuffixes{
        ".gltf", ".glb", ".obj", ".ply", ".stl", ".off"};
    std::size_t checked = 0;
    for (const char* folder : {"models", "cases"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(shared / folder)) {
            const std::string suffix = entry.path().extension().string();
            if (std::find(kSuffixes.begin(), kSuffixes.end(), suffix) == kSuffixes.end()) {
                continue;
            }
            const RunResult result = check_file(
                {entry.path().string(), "--quiet", "--allow-outside", "--rays", "100000"});
            EXPECT_TRUE(result.status == 0 || result.status == 1 || result.status == 3)
                << entry.path() << result.status << result.err;
            ++checked;
        }
    }
    EXPECT_GT(checked, 10U);
}

}  // namespace
}  // namespace earshot::test
