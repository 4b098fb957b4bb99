// SPDX-License-Identifier: MIT
// What `earshot ir` tells of metrics: metrics.json, the table at its end, STI in noise.
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class IrMetrics : public testing::Test {
protected:
    /// Of the shoebox, with exact paths of order 1 where `extra` says no other.
    RunResult ir(const std::vector<std::string>& extra) const {
        std::vector<std::string> arguments = {"ir",
                                              test::source_file("scenes/shoebox.gltf").string(),
                                              "-o",
                                              (folder_.path() / "out").string()};
        if (std::find(extra.begin(), extra.end(), "--order") == extra.end()) {
            arguments.insert(arguments.end(), {"--order", "1"});
        }
        arguments.insert(arguments.end(), extra.begin(), extra.end());
        return run_earshot(arguments);
    }

    std::string file(const std::string& name) const {
        std::ifstream stream(folder_.path() / "out" / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    Json metrics() const { return Json::parse(file("metrics.json")); }
    Json pair() const { return metrics()["pairs"][0]; }

    TemporaryFolder folder_;
};

/// "1.15+-0.012", the error with one digit more.
std::string cell(double value, double error, int decimals) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f+-%.*f", decimals, value, decimals + 1, error);
    return text.data();
}

TEST_F(IrMetrics, StandInATableAtTheEnd) {
    const RunResult result = ir({"--rays", "20000"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json of_pair = pair();
    const Json& single = of_pair["single"];
    const Json& error = of_pair["standard_error"];
    for (const auto& [key, decimals] :
         {std::pair{"t30_mid", 2}, {"edt_mid", 2}, {"c50_mid", 1}, {"c80_mid", 1}}) {
        EXPECT_NE(result.out.find(cell(single[key], error["single"][key], decimals)),
                  std::string::npos)
            << key << "\n"
            << result.out;
    }
    EXPECT_NE(result.out.find(cell(of_pair["sti"], error["sti"], 2)), std::string::npos);
    EXPECT_NE(result.out.find("source to listener"), std::string::npos);
    const Json room = metrics()["room"];
    const auto mid = [&](const char* key) {
        std::array<char, 32> text{};
        std::snprintf(text.data(),
                      text.size(),
                      "%.2f s",
                      0.5 * (room[key][4].get<double>() + room[key][5].get<double>()));
        return std::string(text.data());
    };
    EXPECT_NE(result.out.find("Sabine " + mid("sabine")), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("Eyring " + mid("eyring")), std::string::npos) << result.out;
    std::istringstream table(result.out.substr(result.out.find("\nmetrics ")));
    for (std::string line; std::getline(table, line);) {
        EXPECT_LE(line.size(), 80U) << line;
    }
}

TEST_F(IrMetrics, StandInTheJsonSummaryToo) {
    const RunResult result = ir({"--rays", "20000", "--json", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json summary = Json::parse(result.out);
    const Json of_pair = pair();
    ASSERT_EQ(summary["metrics"].size(), 1U);
    const Json& told = summary["metrics"][0];
    EXPECT_EQ(told["source"], "source");
    EXPECT_EQ(told["listener"], "listener");
    EXPECT_EQ(told["t30_mid"], of_pair["single"]["t30_mid"]);
    EXPECT_EQ(told["standard_error"]["edt_mid"], of_pair["standard_error"]["single"]["edt_mid"]);
    EXPECT_EQ(told["sti"], of_pair["sti"]);
    EXPECT_EQ(summary["room"]["volume"], metrics()["room"]["volume"]);
    EXPECT_GT(summary["room"]["sabine_mid"], summary["room"]["eyring_mid"]);
}

// Sabine's and Eyring's formulas, from the size of the box and its material.
TEST_F(IrMetrics, AreBesideTheTimesOfTheRoom) {
    ASSERT_EQ(ir({"--rays", "2000", "--no-air-absorption", "--quiet"}).status, 0);
    const Json scene =
        Json::parse(std::ifstream(test::source_file("scenes/shoebox.gltf").string()));
    const Json absorption = scene["materials"][0]["extras"]["acoustics"]["absorption"];
    ASSERT_TRUE(absorption.is_number()) << absorption;
    const double alpha = absorption;
    const double per_absorption = 24.0 * std::log(10.0) / 343.2 * 168.0 / 194.0;
    const Json room = metrics()["room"];
    EXPECT_NEAR(room["sabine"][5].get<double>(), per_absorption / alpha, 1e-3);
    EXPECT_NEAR(room["eyring"][5].get<double>(), -per_absorption / std::log(1.0 - alpha), 1e-3);
}

TEST_F(IrMetrics, WithholdWhatFewRaysLeaveUncertain) {
    const RunResult result = ir({"--rays", "2000"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json of_pair = pair();
    const auto has_note = [](const Json& notes, const char* metric, const Json& band_hz) {
        return std::any_of(notes.begin(), notes.end(), [&](const Json& note) {
            return note["metric"] == metric && note["band_hz"] == band_hz;
        });
    };
    EXPECT_TRUE(of_pair["t30"][5].is_null());
    EXPECT_GT(of_pair["standard_error"]["t30"][5].get<double>(), 0.0);
    EXPECT_TRUE(has_note(of_pair["notes"], "t30", 1000.0)) << of_pair["notes"];
    // What was written is told.
    EXPECT_TRUE(of_pair["response"]["t30"][5].is_number());
    EXPECT_TRUE(has_note(of_pair["response"]["notes"], "t30", 1000.0));
    ASSERT_TRUE(of_pair["single"]["t30_mid"].is_null());
    EXPECT_TRUE(has_note(of_pair["notes"], "t30_mid", nullptr));
    EXPECT_NE(result.out.find("T30: standard error"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("more rays (--rays)"), std::string::npos) << result.out;
    // Only what is withheld is missing.
    for (const char* metric : {"edt", "t20", "t30", "c50", "c80", "d50", "ts", "g"}) {
        for (std::size_t band = 0; band < 10; ++band) {
            const Json& value = of_pair[metric][band];
            EXPECT_EQ(value.is_null(),
                      has_note(of_pair["notes"], metric, metrics()["bands_hz"][band]))
                << metric << " " << band;
        }
    }
}

TEST_F(IrMetrics, OfExactPathsHaveNoErrors) {
    ASSERT_EQ(ir({"--order", "4", "--rays", "0", "--quiet"}).status, 0);
    const Json of_pair = pair();
    EXPECT_TRUE(of_pair["t30"][5].is_null());
    EXPECT_TRUE(of_pair["g"][5].is_number());
    EXPECT_TRUE(of_pair["standard_error"]["g"][5].is_null());
    EXPECT_TRUE(of_pair["standard_error"]["sti"].is_null());
}

TEST_F(IrMetrics, AreLeftOutOnDemand) {
    ASSERT_EQ(ir({"--rays", "2000", "--quiet"}).status, 0);
    const std::string sound = file("source__listener.wav");
    fs::remove_all(folder_.path() / "out");
    const RunResult result = ir({"--rays", "2000", "--no-metrics"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_FALSE(fs::exists(folder_.path() / "out" / "metrics.json"));
    EXPECT_EQ(result.out.find("T30"), std::string::npos) << result.out;
    EXPECT_EQ(file("source__listener.wav"), sound);
    const RunResult json = ir({"--rays", "2000", "--no-metrics", "--json"});
    EXPECT_FALSE(Json::parse(json.out).contains("metrics"));
}

TEST_F(IrMetrics, SpeechIsHeardAgainstNoise) {
    const auto index = [&](const std::vector<std::string>& extra) {
        std::vector<std::string> options = {"--rays", "20000", "--quiet"};
        options.insert(options.end(), extra.begin(), extra.end());
        EXPECT_EQ(ir(options).status, 0);
        return pair()["sti"].get<double>();
    };
    const double quiet = index({});
    EXPECT_FALSE(metrics().contains("noise"));
    const double normal = index({"--noise", "NC-40"});
    EXPECT_EQ(metrics()["speech_level"], 60.0);
    EXPECT_EQ(metrics()["noise"], Json({56.0, 50.0, 45.0, 41.0, 39.0, 38.0, 37.0}));
    EXPECT_TRUE(pair()["response"]["sti"].is_number());
    EXPECT_GT(pair()["standard_error"]["sti"].get<double>(), 0.0);
    const double loud = index({"--noise", "NC-40", "--speech-level", "loud"});
    EXPECT_EQ(metrics()["speech_level"], 72.0);
    EXPECT_LT(normal, loud);
    EXPECT_LT(loud, quiet);
    // Curve and level in figures.
    EXPECT_EQ(index({"--noise", "56,50,45,41,39,38,37", "--speech-level", "72"}), loud);
    EXPECT_LT(index({"--speech-level", "10"}), 0.5 * quiet);  // below the threshold of hearing
    EXPECT_TRUE(metrics()["noise"].is_null());
}

TEST_F(IrMetrics, RefuseNoiseAndLevelsOfNoForm) {
    for (const char* noise : {"NC",
                              "NC-",
                              "NC-10",
                              "NC-75",
                              "nc-30",
                              "30",
                              "1,2,3",
                              "1,2,3,4,5,6,x",
                              "1,2,3,4,5,6,7,8",
                              "1,2,3,4,5,6,",
                              "1,2,3,4,5,6,999"}) {
        EXPECT_TRUE(failed_with(ir({"--noise", noise}), 2, "--noise")) << noise;
    }
    for (const char* level : {"quiet", "", "1e9", "nan", "60 dB"}) {
        EXPECT_TRUE(failed_with(ir({"--speech-level", level}), 2, "--speech-level")) << level;
    }
    EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

TEST_F(IrMetrics, AndTheResponseOfAPairDependOnNoOtherPair) {
    const auto of_the_pair = [&](const std::vector<std::string>& others) {
        std::vector<std::string> arguments = others;
        arguments.insert(arguments.end(), {"--source", "s=2,1.5,1", "--listener", "a=3,1.2,2"});
        const RunResult result = ir(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        Json found;
        for (const Json& pair : metrics()["pairs"]) {
            found = pair["source"] == "s" && pair["listener"] == "a" ? pair : found;
        }
        return std::pair(found, file("s__a.wav"));
    };
    const auto alone = of_the_pair({});
    ASSERT_FALSE(alone.second.empty());
    EXPECT_EQ(of_the_pair({"--source", "t=1,1,1", "--listener", "b=4,1.8,3"}), alone);
}

}  // namespace
}  // namespace earshot::test
