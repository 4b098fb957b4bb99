// SPDX-License-Identifier: MIT
// earshot calibrate --locate on a box, with times that its images tell.
#include "earshot/propagation/least_squares.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

using Json = nlohmann::json;
using Point = std::array<double, 3>;

constexpr Point kSize = {5.0, 3.0, 4.0};
constexpr std::array<const char*, 6> kWalls = {
    "west", "east", "floor", "ceiling", "north", "south"};
constexpr Point kSource = {1.0, 1.2, 1.5};
constexpr std::array<Point, 2> kListeners = {{{3.5, 1.7, 2.5}, {2.2, 1.1, 3.1}}};

/// Quadrilaterals with a material each, low and high x, y, z.
constexpr const char* kBox =
    "v 0 0 0\nv 5 0 0\nv 0 3 0\nv 5 3 0\nv 0 0 4\nv 5 0 4\nv 0 3 4\nv 5 3 4\n"
    "usemtl west\nf 1 3 7 5\nusemtl east\nf 2 6 8 4\nusemtl floor\nf 1 5 6 2\n"
    "usemtl ceiling\nf 3 4 8 7\nusemtl north\nf 1 2 4 3\nusemtl south\nf 5 7 8 6\n";

double time_of(const Point& listener, int wall) {
    constexpr double kSpeed = 343.2;  // of air of 20 degrees
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const double image = wall / 2 == axis && wall >= 0
                                 ? (wall % 2 == 1 ? 2.0 * kSize[k] : 0.0) - kSource[k]
                                 : kSource[k];
        square += (listener[k] - image) * (listener[k] - image);
    }
    return std::sqrt(square) / kSpeed;
}

class LocateCommand : public testing::Test {
protected:
    void SetUp() override {
        if (!propagation::least_squares_available()) {
            GTEST_SKIP() << "built without Ceres' headers";
        }
        std::ofstream(folder_.path() / "box.obj") << kBox;
        std::ofstream table(folder_.path() / "arrivals.csv");
        table.precision(12);
        table << "source,listener,surfaces,time\n";
        for (std::size_t i = 0; i < kListeners.size(); ++i) {
            for (int wall = -1; wall < 6; ++wall) {
                table << "s,l" << i << ','
                      << (wall < 0 ? "direct" : kWalls[static_cast<std::size_t>(wall)]) << ','
                      << time_of(kListeners[i], wall) << '\n';
            }
        }
    }

    /// With listeners that are stated 2 cm off.
    RunResult run(std::vector<std::string> more = {}) const {
        std::vector<std::string> arguments = {"calibrate",
                                              (folder_.path() / "box.obj").string(),
                                              "--locate",
                                              (folder_.path() / "arrivals.csv").string(),
                                              "-o",
                                              output().string(),
                                              "--source",
                                              "s=1,1.2,1.5",
                                              "--listener",
                                              "l0=3.52,1.7,2.5",
                                              "--listener",
                                              "l1=2.2,1.1,3.08"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }
    std::filesystem::path output() const { return folder_.path() / "positions.json"; }

    TemporaryFolder folder_;
};

TEST_F(LocateCommand, WritesWhereListenersAre) {
    const RunResult result = run({"--source-error", "0", "--timing-error", "1e-6", "--folds", "5"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("14 of 14 on paths of order up to 1"), std::string::npos);
    EXPECT_NE(result.out.find("held out"), std::string::npos);
    EXPECT_NE(result.out.find("moved by 20.0 mm (median)"), std::string::npos) << result.out;
    const Json json = Json::parse(std::ifstream(output()));
    ASSERT_EQ(json["listeners"].size(), 2U);
    for (std::size_t i = 0; i < kListeners.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(
                json["listeners"][i]["position"][axis].get<double>(), kListeners[i][axis], 3e-4);
        }
    }
    EXPECT_EQ(json["sources"][0]["error"], Json({0.0, 0.0, 0.0}));
    EXPECT_EQ(json["matched"], 14);
    EXPECT_EQ(json["walls"].size(), 6U);
    EXPECT_EQ(json["arrivals"][3]["surfaces"], "floor");
    EXPECT_LT(json["median_error"]["held_out"].get<double>(), 1e-5);
    EXPECT_NEAR(json["speed_of_sound"]["value"].get<double>(), 343.2, 0.05);
}

TEST_F(LocateCommand, PrintsTheSameThatItWrites) {
    const RunResult result = run({"--json", "--latency-error", "0.01", "--wall-error", "0.01"});
    ASSERT_EQ(result.status, 0) << result.err;
    std::ifstream file(output());
    EXPECT_EQ(result.out, std::string(std::istreambuf_iterator<char>(file), {}));
    EXPECT_NE(result.err.find("do not tell common motions"), std::string::npos) << result.err;
}

TEST_F(LocateCommand, SaysWhatItNeeds) {
    EXPECT_TRUE(failed_with(run({"--measured", "x.csv"}), 2, "--locate"));
    std::ofstream(folder_.path() / "arrivals.csv") << "s,l0,roof,0.01\n";
    EXPECT_TRUE(failed_with(run(), 1, "line 1 names the surface 'roof'"));
}

}  // namespace
}  // namespace earshot::test
