// SPDX-License-Identifier: MIT
#include "earshot/propagation/least_squares.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

/// A box of 6 x 3 x 5 m whose floor, ceiling and walls are materials of their own.
constexpr const char* kRoom =
    "v 0 0 0\nv 6 0 0\nv 6 0 5\nv 0 0 5\nv 0 3 0\nv 6 3 0\nv 6 3 5\nv 0 3 5\n"
    "usemtl floor\nf 1 4 3 2\nusemtl ceiling\nf 5 6 7 8\nusemtl wall[1]\nf 1 2 6 5\nf 2 3 7 6\n"
    "f 3 4 8 7\nf 4 1 5 8\n";

class Calibrate : public testing::Test {
protected:
    Calibrate() {
        if (!propagation::least_squares_available()) {
            return;
        }
        std::ofstream(file("room.obj")) << kRoom;
        write_materials(0.3, 0.5, 0.2);
    }

    void SetUp() override {
        if (!propagation::least_squares_available()) {
            GTEST_SKIP() << "built without Ceres";
        }
    }

    std::string file(const std::string& name) const { return (folder_.path() / name).string(); }

    void write_materials(double floor, double ceiling, double wall) const {
        const auto of = [](double absorption) {
            return Json{{"absorption", absorption}, {"scattering", 0.3}};
        };
        std::ofstream(file("room.materials.json"))
            << Json{{"floor", of(floor)}, {"ceiling", of(ceiling)}, {"wall?1?", of(wall)}};
    }

    RunResult run(const std::string& command, std::vector<std::string> more) const {
        std::vector<std::string> arguments = {command,
                                              file("room.obj"),
                                              "--source",
                                              "s=1,1.2,1.5",
                                              "--listener",
                                              "a=4.5,1.6,3.5",
                                              "--listener",
                                              "b=2.5,0.5,4",
                                              "--listener",
                                              "c=3.5,2.4,1",
                                              "--order",
                                              "2",
                                              "--rays",
                                              "2048",
                                              "--threads",
                                              "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }

    TemporaryFolder folder_;
};

// Metrics of the room with the right materials, as a table.
TEST_F(Calibrate, WritesMaterialsThatTheSceneReads) {
    ASSERT_EQ(run("ir", {"-o", file("truth"), "--quiet"}).status, 0);
    const Json truth = Json::parse(read_file(file("truth/metrics.json")));
    std::ofstream table(file("table.csv"));
    table << "source,listener,metric,band,value,error\n";
    for (const Json& pair : truth["pairs"]) {
        for (const char* metric : {"t30", "c80", "g"}) {
            for (const std::size_t band : {4, 5}) {
                if (pair[metric][band].is_number()) {
                    table << pair["source"].get<std::string>() << ','
                          << pair["listener"].get<std::string>() << ',' << metric << ','
                          << truth["bands_hz"][band] << ',' << pair[metric][band] << ",0.01\n";
                }
            }
        }
    }
    table << "s,elsewhere,t30,500,1\n";
    table.close();

    write_materials(0.2, 0.6, 0.15);
    const RunResult fit =
        run("calibrate", {"--measured", file("table.csv"), "-o", file("fitted.json"), "--json"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    EXPECT_NE(fit.err.find("no pair s, elsewhere"), std::string::npos) << fit.err;
    const Json result = Json::parse(fit.out);
    EXPECT_GT(result["bands"][4]["before_jnd"].get<double>(), 1.0);
    EXPECT_LT(result["bands"][4]["after_jnd"].get<double>(), 0.2);
    EXPECT_EQ(result["bands"][6]["values"], 0);
    EXPECT_EQ(result["materials"].size(), 3U);

    // The written file is that of the scene: the metrics are those of the truth.
    const std::string fitted = read_file(file("fitted.json"));
    EXPECT_TRUE(Json::parse(fitted).contains("wall\\[1]")) << fitted;
    std::ofstream(file("room.materials.json")) << fitted;
    ASSERT_EQ(run("ir", {"-o", file("again"), "--quiet"}).status, 0);
    const Json again = Json::parse(read_file(file("again/metrics.json")));
    for (std::size_t pair = 0; pair < 3; ++pair) {
        const double before = truth["pairs"][pair]["g"][4], after = again["pairs"][pair]["g"][4];
        EXPECT_NEAR(after, before, 0.1);
    }

    const RunResult text =
        run("calibrate", {"--measured", file("table.csv"), "-o", file("fitted.json")});
    ASSERT_EQ(text.status, 0);
    for (const char* part : {"18 values of 3 pairs", "differences, JND", "floor", "fitted"}) {
        EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
    }
}

TEST_F(Calibrate, TakesTheRecordingsThatIrWrites) {
    ASSERT_EQ(run("ir", {"-o", file("truth"), "--quiet", "--no-metrics"}).status, 0);
    const RunResult fit = run("calibrate",
                              {"--measured",
                               file("truth"),
                               "--noise-free",
                               "--reference",
                               "0",
                               "--metric",
                               "t30,g",
                               "-o",
                               file("fitted.json"),
                               "--keep",
                               "floor",
                               "--simulations",
                               "2",
                               "--json"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json result = Json::parse(fit.out);
    EXPECT_GT(result["bands"][5]["values"].get<int>(), 3);
    for (const Json& is_fitted : result["materials"][0]["fitted"]) {
        EXPECT_FALSE(is_fitted.get<bool>());
    }
}

TEST_F(Calibrate, FitsScatteringIfAskedFor) {
    std::ofstream(file("table.csv")) << "s,a,t30,500,0.4,0.01\ns,b,c80,500,9,0.3\n";
    const auto calibrate = [&](std::vector<std::string> more) {
        more.insert(more.begin(),
                    {"--measured",
                     file("table.csv"),
                     "-o",
                     file("fitted.json"),
                     "--keep",
                     "floor",
                     "--simulations",
                     "1"});
        return run("calibrate", more);
    };
    const RunResult kept = calibrate({"--json"});
    ASSERT_EQ(kept.status, 0) << kept.err;
    EXPECT_FALSE(Json::parse(kept.out)["materials"][0].contains("scattering"));
    const RunResult fit = calibrate({"--json", "--fit-scattering"});
    ASSERT_EQ(fit.status, 0) << fit.err;
    const Json result = Json::parse(fit.out);
    const Json floor = result["materials"][0]["scattering"];
    const Json ceiling = result["materials"][1]["scattering"];
    EXPECT_FALSE(floor["fitted"][4].get<bool>());
    EXPECT_TRUE(ceiling["fitted"][4].get<bool>());
    EXPECT_FALSE(ceiling["fitted"][5].get<bool>());  // no band of the measurements
    EXPECT_EQ(ceiling["prior"][4], 0.3);
    EXPECT_LT(ceiling["interval"][4][0], ceiling["value"][4]);
    // Two values cannot tell scattering from absorption.
    const Json& groups = result["groups"];
    EXPECT_TRUE(std::any_of(groups.begin(), groups.end(), [](const Json& group) {
        return group.contains("scattering") && !group.contains("mean");
    }));
    const RunResult text = calibrate({"--fit-scattering"});
    EXPECT_NE(text.out.find("\nscattering\n"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("scattering of ceiling"), std::string::npos) << text.out;
    // The file of materials holds it.
    const Json materials = Json::parse(read_file(file("fitted.json")));
    EXPECT_TRUE(materials["ceiling"]["scattering"].is_object() ||
                materials["ceiling"]["scattering"].is_array())
        << materials["ceiling"];
}

TEST_F(Calibrate, RefusesWhatItCannotUse) {
    std::ofstream(file("bad.csv")) << "s,a,t30,500,zero\n";
    std::ofstream(file("good.csv")) << "s,a,t30,500,1\n";
    const auto calibrate = [&](const std::string& measured, std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"--measured", file(measured), "-o", file("out.json")});
        return run("calibrate", more);
    };
    EXPECT_TRUE(failed_with(calibrate("absent"), 1, "absent"));
    EXPECT_TRUE(failed_with(calibrate("bad.csv"), 1, "line 1"));
    EXPECT_TRUE(failed_with(calibrate("good.csv", {"--metric", "t60"}), 1, "t60"));
    EXPECT_TRUE(failed_with(calibrate("good.csv", {"--keep", "roof"}), 1, "roof"));
    EXPECT_TRUE(failed_with(calibrate("good.csv", {"--keep", "*"}), 1, "fit"));
    EXPECT_TRUE(failed_with(calibrate("good.csv", {"--error", "0"}), 2, "--error"));
    EXPECT_FALSE(std::ifstream(file("out.json")).good());
}

}  // namespace
}  // namespace earshot::test
