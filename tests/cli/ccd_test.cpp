// SPDX-License-Identifier: MIT

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

/// A vertex that falls through a triangle half-way, and one that stops above it; the second is said
/// to touch.
const std::string kTwoQueries =
    "1,4,1,1,1,4,1\n0,1,0,1,0,1,1\n1,1,0,1,0,1,1\n0,1,0,1,1,1,1\n"
    "1,4,-1,1,1,4,1\n0,1,0,1,0,1,1\n1,1,0,1,0,1,1\n0,1,0,1,1,1,1\n"
    "1,4,1,1,1,4,1\n0,1,0,1,0,1,1\n1,1,0,1,0,1,1\n0,1,0,1,1,1,1\n"
    "1,4,1,1000000000000000000000000,1,4,1\n0,1,0,1,0,1,1\n1,1,0,1,0,1,1\n0,1,0,1,1,1,1\n";

class Ccd : public testing::Test {
protected:
    RunResult ask(const std::string& text, std::vector<std::string> extra = {}) const {
        std::ofstream(folder_.path() / "queries.csv") << text;
        std::vector<std::string> arguments = {"ccd",
                                              (folder_.path() / "queries.csv").string(),
                                              "--kind",
                                              "vertex-face",
                                              "-o",
                                              (folder_.path() / "out.csv").string()};
        arguments.insert(arguments.end(), extra.begin(), extra.end());
        return run_earshot(arguments);
    }

    const TemporaryFolder folder_;
};

TEST_F(Ccd, WritesHitsAndTimesAndCountsFaults) {
    const RunResult result = ask(kTwoQueries, {"--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const std::string text = read_file(folder_.path() / "out.csv");
    ASSERT_TRUE(text.starts_with("1,0.49999")) << text;
    EXPECT_TRUE(text.ends_with("\n0,\n")) << text;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["queries"], 2);
    EXPECT_EQ(json["hits"], 1);
    EXPECT_EQ(json["false_positives"], 0);
    EXPECT_EQ(json["false_negatives"], 1);
    EXPECT_NE(ask(kTwoQueries).out.find("1 false negatives of 2"), std::string::npos);
}

TEST_F(Ccd, MinimumSeparationFindsWhatStopsShort) {
    ASSERT_EQ(ask(kTwoQueries.substr(0, kTwoQueries.find("1000000") - 2) + "1,64,1,4,1\n" +
                      "0,1,0,1,0,1,1\n1,1,0,1,0,1,1\n0,1,0,1,1,1,1\n",
                  {"--min-separation", "0.1"})
                  .status,
              0);
    const std::string text = read_file(folder_.path() / "out.csv");
    EXPECT_EQ(std::count(text.begin(), text.end(), '1') >= 2, true) << text;
    EXPECT_EQ(text.find("0,\n"), std::string::npos) << text;
}

TEST_F(Ccd, FaultsNameTheLine) {
    const auto fault = [&](const std::string& text) {
        const RunResult result = ask(text);
        EXPECT_EQ(result.status, 1);
        EXPECT_FALSE(fs::exists(folder_.path() / "out.csv"));
        return result.err;
    };
    EXPECT_NE(fault("1,4,1,1,1\n").find("line 1"), std::string::npos);
    EXPECT_NE(fault("1,4,1,1,1,4,1\n1,0,1,1,1,4,1\n").find("line 2"), std::string::npos);
    EXPECT_NE(fault("1,4,1,1,1,x,1\n").find("line 1"), std::string::npos);
    EXPECT_NE(fault("1,4,1,1,1,4,2\n").find("neither 0 nor 1"), std::string::npos);
    EXPECT_NE(fault("1,4,1,1,1,4,1\n").find("within a query"), std::string::npos);
    EXPECT_EQ(run_earshot({"ccd", "no.csv", "--kind", "edge-edge", "-o", "x.csv"}).status, 1);
    EXPECT_EQ(run_earshot({"ccd", "no.csv", "--kind", "both", "-o", "x.csv"}).status, 2);
}

/// The hand-made samples of Wang et al. 2021: exactly decided.
TEST_F(Ccd, SampleQueriesHaveNoFalseAnswer) {
    const fs::path samples = test::shared_file("reference/ccd");
    if (!fs::exists(samples)) {
        GTEST_SKIP() << "reference/ccd is not there";
    }
    std::size_t queries = 0;
    for (const auto& entry : fs::recursive_directory_iterator(samples)) {
        if (entry.path().extension() != ".csv") {
            continue;
        }
        const RunResult result = run_earshot({"ccd",
                                              entry.path().string(),
                                              "--kind",
                                              entry.path().parent_path().filename().string(),
                                              "-o",
                                              (folder_.path() / "out.csv").string(),
                                              "--json"});
        ASSERT_EQ(result.status, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out);
        EXPECT_EQ(json["false_positives"], 0) << entry.path();
        EXPECT_EQ(json["false_negatives"], 0) << entry.path();
        queries += json["queries"].get<std::size_t>();
    }
    EXPECT_EQ(queries, 2824U);
}

}  // namespace
}  // namespace earshot::test
