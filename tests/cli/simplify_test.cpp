// SPDX-License-Identifier: MIT

#include "earshot/geometry/simplify.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <filesystem>
#include <fstream>
#include <sstream>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

class SimplifyCommand : public ::testing::Test {
protected:
    void SetUp() override {
        if (!geometry::simplify_available()) {
            GTEST_SKIP() << "built without OpenMesh";
        }
    }

    /// A box of 6 x 3 x 4 m whose sides are grids of 8 x 8 cells, with a bump on its floor.
    std::string write_room(double bump) const {
        std::ostringstream text;
        text.precision(17);
        int count = 0;
        const double size[3] = {6.0, 3.0, 4.0};
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                for (int j = 0; j <= 8; ++j) {
                    for (int i = 0; i <= 8; ++i) {
                        double p[3] = {};
                        p[axis] = side * size[axis];
                        p[(axis + 1) % 3] = size[(axis + 1) % 3] * i / 8.0;
                        p[(axis + 2) % 3] = size[(axis + 2) % 3] * j / 8.0;
                        if (axis == 1 && side == 0 && i == 4 && j == 4) {
                            p[1] += bump;
                        }
                        text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
                    }
                }
                text << "usemtl " << (axis == 1 ? "carpet-thin" : "brick-painted") << '\n';
                for (int j = 0; j < 8; ++j) {
                    for (int i = 0; i < 8; ++i) {
                        const int a = count + 9 * j + i + 1;
                        const int quad[4] = {a, a + 1, a + 10, a + 9};
                        text << 'f';
                        for (int k = 0; k < 4; ++k) {
                            text << ' ' << quad[side == 0 ? k : 3 - k];
                        }
                        text << '\n';
                    }
                }
                count += 81;
            }
        }
        const std::string file = (folder_.path() / "room.obj").string();
        std::ofstream(file) << text.str();
        return file;
    }

    std::string path(const char* name) const { return (folder_.path() / name).string(); }

    TemporaryFolder folder_;
};

TEST_F(SimplifyCommand, MergesAndReportsAsJson) {
    const std::string room = write_room(0.004);
    const std::string original = read_file(room);
    const RunResult result =
        run_earshot({"simplify", room, "-o", path("simple.glb"), "--json", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(read_file(room), original);
    const Json report = Json::parse(result.out);
    EXPECT_EQ(report["version"], 1);
    EXPECT_EQ(report["triangles"]["before"], 768);
    EXPECT_EQ(report["triangles"]["after"], 12);
    EXPECT_LE(report["surfaces"]["to_simplified"]["upper"], 0.01);
    EXPECT_GE(report["surfaces"]["to_simplified"]["upper"], 0.004);
    EXPECT_NEAR(report["surfaces"]["to_simplified"]["lower"].get<double>(), 0.004, 1e-6);
    EXPECT_NEAR(report["absorption_area"]["before"]["1000"].get<double>(),
                report["absorption_area"]["after"]["1000"].get<double>(),
                1e-9);
    EXPECT_FALSE(report.contains("pairs"));  // nobody to listen
    // The floor absorbs more, as it lost area.
    const Json materials = Json::parse(read_file(path("simple.materials.json")));
    EXPECT_TRUE(materials.contains("carpet-thin"));
    EXPECT_FALSE(materials.contains("brick-painted"));
    const RunResult read = run_earshot({"check", path("simple.glb"), "--json", "--forecast", "0"});
    EXPECT_EQ(Json::parse(read.out)["verdict"], "clean") << read.out;
}

TEST_F(SimplifyCommand, ComparesWhatIsHeard) {
    const std::string room = write_room(0.0);
    const RunResult result = run_earshot({"simplify",
                                          room,
                                          "-o",
                                          path("simple.glb"),
                                          "--source",
                                          "s=1,1.5,1",
                                          "--listener",
                                          "l=5,1.2,3",
                                          "--order",
                                          "1",
                                          "--rays",
                                          "2000",
                                          "--json",
                                          "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json report = Json::parse(result.out);
    ASSERT_EQ(report["pairs"].size(), 1U);
    EXPECT_EQ(report["pairs"][0]["source"], "s");
    EXPECT_EQ(report["pairs"][0]["paths"]["before"], 7);
    EXPECT_EQ(report["pairs"][0]["paths"]["after"], 7);
    EXPECT_NEAR(report["pairs"][0]["c80_mid"]["jnd"].get<double>(), 0.0, 0.5);
    EXPECT_TRUE(report["compared_seconds"].contains("paths"));
    EXPECT_FALSE(std::filesystem::exists(path("simple.materials.json")));
}

TEST_F(SimplifyCommand, PrintsTextWithTheDistance) {
    const RunResult result = run_earshot(
        {"simplify", write_room(0.0), "-o", path("simple.glb"), "--max-frequency", "1000"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("room.obj: within 42.9 mm"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("768 -> 12"), std::string::npos) << result.out;
}

TEST_F(SimplifyCommand, NeverWritesOverTheModel) {
    const RunResult first =
        run_earshot({"simplify", write_room(0.0), "-o", path("simple.glb"), "--quiet"});
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_TRUE(failed_with(run_earshot({"simplify", path("simple.glb"), "-o", path("simple.glb")}),
                            1,
                            "is the model itself"));
}

TEST_F(SimplifyCommand, RefusesScenesThatMove) {
    EXPECT_TRUE(failed_with(
        run_earshot(
            {"simplify", source_file("scenes/door.gltf").string(), "-o", path("simple.glb")}),
        1,
        "moves"));
}

TEST_F(SimplifyCommand, NeedsOneBoundOnly) {
    const RunResult result = run_earshot({"simplify",
                                          write_room(0.0),
                                          "-o",
                                          path("simple.glb"),
                                          "--distance",
                                          "0.02",
                                          "--max-frequency",
                                          "500"});
    EXPECT_EQ(result.status, 2);
}

}  // namespace
}  // namespace earshot::test
