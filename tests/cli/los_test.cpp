// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <fstream>
#include <iterator>
#include <string>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

class Los : public testing::Test {
protected:
    Los() {
        // A wall at x = 1 between y = 0 and 2, as an OBJ of two materials.
        std::ofstream(path("wall.obj")) << "v 1 0 -1\nv 1 2 -1\nv 1 2 1\nv 1 0 1\nusemtl glass\n"
                                           "f 1 2 3\nusemtl brick\nf 1 3 4\n";
        std::ofstream(path("to.csv")) << "x,y,z\n2,1.5,-0.5\n2,0.5,0.5\n2,9,0\n";
    }

    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    std::string text_of(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    RunResult run(std::vector<std::string> extra, const std::string& output) const {
        std::vector<std::string> command{
            "los", path("wall.obj"), "--from", "0,1.5,-0.5", "--to", path("to.csv")};
        command.insert(command.end(), extra.begin(), extra.end());
        command.insert(command.end(), {"-o", path(output), "--quiet"});
        return run_earshot(command);
    }

    const TemporaryFolder folder_;
};

TEST_F(Los, WritesAMatrix) {
    const RunResult result = run({}, "sight.csv");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(text_of("sight.csv"), "0,0,1\n");
    EXPECT_EQ(run({"--blockers"}, "sight.csv").status, 0);
    EXPECT_EQ(text_of("sight.csv"), "0,0,\n");
    EXPECT_EQ(run({"--ignore", "glass", "--blockers"}, "sight.csv").status, 0);
    // The second line of sight crosses the edge that both materials share.
    EXPECT_EQ(text_of("sight.csv"), ",1,\n");
    EXPECT_EQ(run({"--ignore", "glass", "--ignore", "brick"}, "sight.csv").status, 0);
    EXPECT_EQ(text_of("sight.csv"), "1,1,1\n");
}

TEST_F(Los, WritesHowMuchOfABallIsSeen) {
    // Behind the wall, with half of it over its upper edge, and in the open.
    std::ofstream(path("to.csv")) << "2,1,0\n2,2.5,0\n0,9,0\n";
    ASSERT_EQ(run({"--radius", "0.2", "--rays", "512"}, "shares.csv").status, 0);
    const std::string text = text_of("shares.csv");
    EXPECT_TRUE(text.starts_with("0.0,") && text.ends_with(",1.0\n")) << text;
    ASSERT_EQ(run({"--radius", "0.2"}, "shares.json").status, 0);
    const Json json = Json::parse(text_of("shares.json"));
    const Json& row = json["frames"][0]["shares"][0];
    EXPECT_EQ(row[0], Json::parse("[0.0,0.0]"));
    EXPECT_GT(row[1][0], 0.3);
    EXPECT_LT(row[1][0], 0.7);
    EXPECT_LT(row[1][1], 0.03);
    EXPECT_EQ(row[2], Json::parse("[1.0,0.0]"));
    EXPECT_TRUE(failed_with(run({"--radius", "0.2", "--blockers"}, "shares.csv"), 2, "--radius"));
}

TEST_F(Los, WritesJsonWithThePoints) {
    ASSERT_EQ(run({"--json"}, "sight.json").status, 0);
    const Json json = Json::parse(text_of("sight.json"));
    EXPECT_EQ(json["version"], 1);
    EXPECT_EQ(json["from"], Json::parse("[[0.0,1.5,-0.5]]"));
    EXPECT_EQ(json["to"].size(), 3U);
    EXPECT_EQ(json["frames"][0]["visible"], Json::parse("[[0,0,1]]"));
    ASSERT_EQ(run({"--blockers"}, "sight.json").status, 0);
    EXPECT_EQ(Json::parse(text_of("sight.json"))["frames"][0]["blockers"],
              Json::parse("[[0,0,null]]"));
}

TEST_F(Los, FollowsAnAnimationFrameByFrame) {
    const std::string door = test::source_file("scenes/door.gltf").string();
    const std::vector<std::string> job{
        "los", door, "--from", "1,1.5,1", "--to", path("to.csv"), "--quiet"};
    const auto run_with = [&](const std::vector<std::string>& extra) {
        std::vector<std::string> command = job;
        command.insert(command.end(), extra.begin(), extra.end());
        return run_earshot(command).status;
    };
    ASSERT_EQ(run_with({"--frames", "0:1:0.5", "-o", path("all.csv")}), 0);
    ASSERT_EQ(run_with({"--frames", "0:1:0.5", "-o", path("all.json")}), 0);
    const Json frames = Json::parse(text_of("all.json"))["frames"];
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[2]["time"], 1.0);
    ASSERT_EQ(run_with({"--time", "1", "-o", path("one.csv")}), 0);
    EXPECT_EQ(text_of("all__0002.csv"), text_of("one.csv"));
    EXPECT_NE(text_of("all__0000.csv"), "");
}

// A triangle without area blocks nothing, with --blockers or without, alone or among others, which
// once changed the answer. The first case is a line that a real segment grazes.
TEST_F(Los, TrianglesWithoutAreaChangeNothing) {
    struct Case {
        std::string corners, from, to;
    };
    for (const Case& c : {Case{"v -3.0328450202941895 0.86706101894378662 -2.4652500152587891\n"
                               "v -3.0328450202941895 0.86706101894378662 -2.4732489585876465\n"
                               "v -3.0328450202941895 0.86706101894378662 -2.4656500816345215\n",
                               "-0.37648,1.87716,-3.47577",
                               "-1.4621,1.4187,2.21198"},
                          Case{"v 1 1 1\nv 3 3 3\nv 2 2 2\n", "0,0,0", "4,4,4"},
                          Case{"v 1 1 1\nv 1 1 1\nv 2 1 1\n", "1.5,0,1", "1.5,2,1"},
                          Case{"v 1 1 1\nv 1 1 1\nv 1 1 1\n", "1,1,0", "1,1,1"}}) {
        for (const int far : {1, 41}) {
            std::ofstream obj(path("flat.obj"));
            obj << c.corners;
            for (int i = 0; i < far; ++i) {
                obj << "v " << 10 + i << " 0 0\nv " << 11 + i << " 0 0\nv " << 10 + i << " 1 0\n";
            }
            for (int i = 0; i <= far; ++i) {
                obj << "f " << 3 * i + 1 << ' ' << 3 * i + 2 << ' ' << 3 * i + 3 << '\n';
            }
            obj.close();
            for (const bool blockers : {false, true}) {
                std::vector<std::string> command{"los",
                                                 path("flat.obj"),
                                                 "--from=" + c.from,
                                                 "--to=" + c.to,
                                                 "-o",
                                                 path("flat.csv"),
                                                 "--quiet"};
                if (blockers) {
                    command.emplace_back("--blockers");
                }
                const RunResult result = run_earshot(command);
                ASSERT_EQ(result.status, 0) << result.err;
                EXPECT_EQ(text_of("flat.csv"), blockers ? "\n" : "1\n") << c.corners << far;
            }
        }
    }
}

TEST_F(Los, SaysWhatIsWrong) {
    EXPECT_TRUE(failed_with(run({"--ignore", "glas"}, "x.csv"), 1, "did you mean glass?"));
    std::ofstream(path("to.csv")) << "1,2\n";
    EXPECT_TRUE(failed_with(run({}, "x.csv"), 1, "line 1 is not a point"));
    const auto from = [&](const std::string& points) {
        return run_earshot(
            {"los", path("wall.obj"), "--from", points, "--to", "1,1,1", "-o", path("x.csv")});
    };
    EXPECT_TRUE(failed_with(from("1,2"), 1, "not of the form X,Y,Z"));
    EXPECT_TRUE(failed_with(from(path("absent")), 1, "no such file"));
    EXPECT_TRUE(failed_with(
        run_earshot(
            {"los", path("wall.obj"), "--from", "0,0,0", "--to", "1,1,1", "-o", path("no/x.csv")}),
        1,
        "cannot be written"));
    EXPECT_TRUE(failed_with(run_earshot({"los", path("wall.obj")}), 2, "--from"));
}

}  // namespace
}  // namespace earshot::test
