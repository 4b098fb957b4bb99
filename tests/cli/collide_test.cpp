// SPDX-License-Identifier: MIT

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/test_paths.h"
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class Collide : public testing::Test {
protected:
    Collide() { fs::create_directories(folder_); }
    ~Collide() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// A floor and a triangle above it at `height`, one mesh.
    std::string pose(const std::string& name, double height) const {
        std::ofstream file(folder_ / name);
        file << "OFF\n6 2 0\n-4 0 -4\n-4 0 4\n4 0 0\n0 " << height << " 0\n1 " << height + 1
             << " 0\n0 " << height + 1 << " 1\n3 0 1 2\n3 3 4 5\n";
        return path(name);
    }

    const fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("earshot_collide_" +
         std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(Collide, PosesOfOneMeshAreSteps) {
    const RunResult result = run_earshot({"collide",
                                          pose("a.off", 2.0),
                                          pose("b.off", 1.0),
                                          pose("c.off", -0.5),
                                          "-o",
                                          path("contacts.json"),
                                          "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(read_file(folder_ / "contacts.json"));
    EXPECT_EQ(json["version"], 1);
    ASSERT_EQ(json["steps"].size(), 2U);
    EXPECT_TRUE(json["steps"][0]["contacts"].empty());
    const Json contacts = json["steps"][1]["contacts"];
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts[0]["kind"], "vertex_face");
    EXPECT_EQ(contacts[0]["a"], Json({{"mesh", 0}, {"element", {3}}}));
    EXPECT_EQ(contacts[0]["b"], Json({{"mesh", 0}, {"element", {0, 1, 2}}}));
    EXPECT_LE(contacts[0]["toi"].get<double>(), 2.0 / 3.0);
    EXPECT_NEAR(contacts[0]["toi"].get<double>(), 2.0 / 3.0, 1e-11);
    EXPECT_NEAR(contacts[0]["normal"][1].get<double>(), 1.0, 1e-12);
    EXPECT_EQ(Json::parse(result.out)["contacts"], 1);
}

TEST_F(Collide, TablesHoldTheSame) {
    ASSERT_EQ(run_earshot(
                  {"collide", pose("a.off", 1.0), pose("b.off", -0.5), "-o", path("contacts.csv")})
                  .status,
              0);
    const std::string text = read_file(folder_ / "contacts.csv");
    EXPECT_TRUE(text.starts_with("t0,t1,kind,")) << text;
    EXPECT_NE(text.find("0.0,1.0,vertex_face,0,3,0,0 1 2,0.66666"), std::string::npos) << text;
}

TEST_F(Collide, DiscreteContactsAreAtInstants) {
    ASSERT_EQ(run_earshot({"collide",
                           pose("a.off", 1.0),
                           pose("b.off", -0.5),
                           "--discrete",
                           "-o",
                           path("contacts.json")})
                  .status,
              0);
    const Json json = Json::parse(read_file(folder_ / "contacts.json"));
    ASSERT_EQ(json["steps"].size(), 2U);
    EXPECT_TRUE(json["steps"][0]["contacts"].empty());
    const Json& step = json["steps"][1];
    EXPECT_EQ(step["t0"], step["t1"]);
    ASSERT_EQ(step["contacts"].size(), 1U);
    EXPECT_EQ(step["contacts"][0]["kind"], "triangle_triangle");
    EXPECT_EQ(step["contacts"][0]["b"]["element"], Json({3, 4, 5}));
}

TEST_F(Collide, AnAnimationIsTheSameForAnyNumberOfThreads) {
    const std::string scene = test::source_file("scenes/curtain.gltf").string();
    std::vector<std::string> texts;
    for (const char* threads : {"1", "2", "8"}) {
        const RunResult result = run_earshot({"collide",
                                              scene,
                                              "--frames",
                                              "0:0.6:0.2",
                                              "--self",
                                              "--min-separation",
                                              "0.001",
                                              "--tolerance",
                                              "0.001",
                                              "-o",
                                              path("contacts.json"),
                                              "--threads",
                                              threads});
        ASSERT_EQ(result.status, 0) << result.err;
        texts.push_back(read_file(folder_ / "contacts.json"));
        EXPECT_EQ(Json::parse(texts.back())["steps"].size(), 3U);
    }
    EXPECT_EQ(texts[0], texts[1]);
    EXPECT_EQ(texts[0], texts[2]);
}

TEST_F(Collide, SaysInOneLineWhatIsWrongAndWritesNothing) {
    std::ofstream(path("other.off")) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::ofstream(path("nan.off")) << "OFF\n3 1 0\n0 nan 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::ofstream(path("empty.off")) << "OFF\n0 0 0\n";
    const std::string a = pose("a.off", 1.0), b = pose("b.off", -0.5), out = path("contacts.json");
    struct Case {
        int status;
        std::string says;
        std::vector<std::string> arguments;
    };
    const std::vector<Case> cases{
        {1, "other.off", {a, path("other.off"), "-o", out}},
        {1, "nan.off", {a, path("nan.off"), "-o", out}},
        {1, "empty.off", {path("empty.off"), "-o", out}},
        {1, "no.gltf", {path("no.gltf"), "-o", out}},
        {1, "none/contacts.json", {a, b, "-o", path("none/contacts.json")}},
        {1, "is a directory", {a, b, "-o", folder_.string()}},
        {2, "--output", {a}},
        {2, "FILES", {"-o", out}},
        {2, "--frames", {a, "-o", out, "--frames", "1"}},
        {2, "--frames", {a, b, "-o", out, "--frames", "0:1:0.1"}},
        {2, "--animation", {a, b, "-o", out, "--animation", "walk"}},
        {2, "--min-separation", {a, b, "-o", out, "--min-separation", "-1"}},
        {2, "--min-separation", {a, b, "-o", out, "--min-separation", "nan"}},
        {2, "--tolerance", {a, b, "-o", out, "--tolerance", "0"}},
    };
    const auto files = [&] {
        return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
    };
    const auto before = files();
    for (const Case& each : cases) {
        std::vector<std::string> arguments{"collide"};
        arguments.insert(arguments.end(), each.arguments.begin(), each.arguments.end());
        const RunResult result = run_earshot(arguments);
        EXPECT_EQ(result.status, each.status) << each.says;
        EXPECT_TRUE(result.err.starts_with("earshot: error: ")) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_NE(result.err.find(each.says), std::string::npos) << result.err;
        EXPECT_EQ(result.out, "") << each.says;
        EXPECT_EQ(files(), before) << each.says;
    }
}

TEST_F(Collide, TakesTrianglesWithoutArea) {
    // A vertex that falls onto a segment, which is what the floor is.
    const auto write = [&](const char* name, double height) {
        std::ofstream(path(name)) << "OFF\n6 2 0\n-4 0 0\n4 0 0\n0 0 0\n0 " << height << " 0\n1 "
                                  << height + 1 << " 0\n0 " << height + 1
                                  << " 1\n3 0 1 2\n3 3 4 5\n";
        return path(name);
    };
    const RunResult result = run_earshot(
        {"collide", write("a.off", 1.0), write("b.off", -1.0), "-o", path("contacts.json")});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json contacts = Json::parse(read_file(folder_ / "contacts.json"))["steps"][0]["contacts"];
    ASSERT_FALSE(contacts.empty());
    EXPECT_EQ(contacts[0]["kind"], "vertex_face");
    EXPECT_LE(contacts[0]["toi"].get<double>(), 0.5);
    EXPECT_NEAR(contacts[0]["toi"].get<double>(), 0.5, 1e-11);
}

}  // namespace
}  // namespace earshot::test
