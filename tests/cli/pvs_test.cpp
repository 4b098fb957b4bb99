// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <string>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

/// Two closed rooms side by side, 3 m wide, that share no wall: quads of a box each.
class Pvs : public testing::Test {
protected:
    Pvs() {
        std::ofstream obj(path("rooms.obj"));
        for (const int x : {0, 4}) {
            for (int corner = 0; corner < 8; ++corner) {
                obj << "v " << x + 3 * (corner & 1) << ' ' << 3 * (corner >> 1 & 1) << ' '
                    << 3 * (corner >> 2) << '\n';
            }
        }
        for (const int first : {1, 9}) {
            for (const auto& [a, b, c, d] : {std::array{0, 1, 3, 2},
                                             {4, 5, 7, 6},
                                             {0, 1, 5, 4},
                                             {2, 3, 7, 6},
                                             {0, 2, 6, 4},
                                             {1, 3, 7, 5}}) {
                obj << "f " << first + a << ' ' << first + b << ' ' << first + c << ' ' << first + d
                    << '\n';
            }
        }
    }

    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    RunResult build(std::vector<std::string> extra, const std::string& output = "rooms.pvs") const {
        std::vector<std::string> command{"pvs", "build", path("rooms.obj"), "-o", path(output)};
        command.insert(command.end(), extra.begin(), extra.end());
        command.push_back("--quiet");
        return run_earshot(command);
    }

    Json query(const std::string& file, const std::string& at) const {
        const RunResult result = run_earshot(
            {"pvs", "query", path(file), "--at", at, "-o", path("seen.json"), "--quiet"});
        EXPECT_EQ(result.status, 0) << result.err;
        std::ifstream stream(path("seen.json"));
        return Json::parse(stream)["triangles"];
    }

    const TemporaryFolder folder_;
};

const Json kLeftRoom = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
const Json kRightRoom = {12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23};

TEST_F(Pvs, FindsTheRoomOfARegion) {
    ASSERT_EQ(build({"--region", "1,1,1:2,2,2", "--rays", "20000"}).status, 0);
    EXPECT_EQ(query("rooms.pvs", "1.5,1.5,1.5"), kLeftRoom);
    const RunResult outside = run_earshot({"pvs", "query", path("rooms.pvs"), "--at", "5,1,1"});
    EXPECT_EQ(outside.status, 1);
    EXPECT_NE(outside.err.find("lies outside of the region"), std::string::npos);
}

TEST_F(Pvs, FindsTheRoomsOfCells) {
    // Cells of 1 m; those that hold a wall see both of its sides.
    ASSERT_EQ(build({"--region", "0.5,0.5,0.5:6.5,2.5,2.5", "--grid", "6,1,1", "--rays", "400000"})
                  .status,
              0);
    EXPECT_EQ(query("rooms.pvs", "1,1,1"), kLeftRoom);
    EXPECT_EQ(query("rooms.pvs", "6,1,1"), kRightRoom);
}

TEST_F(Pvs, DividesAndMergesCells) {
    ASSERT_EQ(
        build({"--region", "0.5,0.5,0.5:6.5,2.5,2.5", "--cells", "8", "--rays", "400000"}).status,
        0);
    EXPECT_EQ(query("rooms.pvs", "1,1,1"), kLeftRoom);
    ASSERT_EQ(
        run_earshot(
            {"pvs", "extract", path("rooms.pvs"), "--cells", "1", "-o", path("one.pvs"), "--quiet"})
            .status,
        0);
    EXPECT_EQ(query("one.pvs", "1,1,1").size(), 24U);
    const RunResult again =
        run_earshot({"pvs", "extract", path("one.pvs"), "--cells", "1", "-o", path("two.pvs")});
    EXPECT_EQ(again.status, 1);
    EXPECT_NE(again.err.find("have no history"), std::string::npos);
    const RunResult little =
        run_earshot({"pvs", "extract", path("rooms.pvs"), "--memory", "3", "-o", path("two.pvs")});
    EXPECT_EQ(little.status, 1);
}

TEST_F(Pvs, IsTheSameForAnyThreadsAndBySeed) {
    std::vector<std::string> bytes;
    for (const char* threads : {"1", "2", "8"}) {
        ASSERT_EQ(build({"--cells", "6", "--rays", "100000", "--threads", threads}).status, 0);
        std::ifstream stream(path("rooms.pvs"), std::ios::binary);
        bytes.emplace_back(std::istreambuf_iterator<char>(stream),
                           std::istreambuf_iterator<char>());
    }
    EXPECT_EQ(bytes[0], bytes[1]);
    EXPECT_EQ(bytes[0], bytes[2]);
    EXPECT_GT(bytes[0].size(), 300U);
}

TEST_F(Pvs, ShowsWhatAFileHolds) {
    ASSERT_EQ(build({"--grid", "2,1,1", "--objects", "4", "--seconds", "0.5"}).status, 0);
    const RunResult text = run_earshot({"pvs", "show", path("rooms.pvs")});
    EXPECT_EQ(text.status, 0);
    EXPECT_NE(text.out.find("Cells that see the most"), std::string::npos);
    EXPECT_NE(text.out.find("Fewer cells"), std::string::npos);
    const RunResult result = run_earshot({"pvs", "show", path("rooms.pvs"), "--json"});
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["cells"], 2);
    EXPECT_EQ(json["triangles"], 24);
    EXPECT_LT(json["objects"], 24);
    EXPECT_EQ(json["scene"], "rooms.obj");
}

TEST_F(Pvs, PrunesSoundPathsAndTellsWhatThatCost) {
    ASSERT_EQ(build({"--region", "0.5,0.5,0.5:2.5,2.5,2.5"}).status, 0);
    const auto ir = [&](std::vector<std::string> extra) {
        std::vector<std::string> command{"ir",
                                         path("rooms.obj"),
                                         "-o",
                                         path("out"),
                                         "--source",
                                         "1,1,1",
                                         "--listener",
                                         "2,2,2",
                                         "--order",
                                         "2",
                                         "--rays",
                                         "0",
                                         "--json"};
        command.insert(command.end(), extra.begin(), extra.end());
        return run_earshot(command);
    };
    const Json complete = Json::parse(ir({}).out);
    const RunResult result = ir({"--visibility", path("rooms.pvs"), "--check-visibility"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json pruned = Json::parse(result.out);
    EXPECT_EQ(pruned["paths_per_order"], complete["paths_per_order"]);
    EXPECT_EQ(pruned["paths_lost_to_visible_sets"], 0);
    EXPECT_FALSE(complete.contains("paths_lost_to_visible_sets"));
    // A file of another scene.
    std::ofstream(path("rooms.obj"), std::ios::app) << "v 1 1 1\nf 1 2 17\n";
    const RunResult other = ir({"--visibility", path("rooms.pvs")});
    EXPECT_EQ(other.status, 1);
    EXPECT_NE(other.err.find("visible sets"), std::string::npos) << other.err;
    EXPECT_EQ(ir({"--check-visibility"}).status, 2);
}

TEST_F(Pvs, ValidatesItsSetsAndTellsTheBound) {
    ASSERT_EQ(build({"--region", "1,1,1:2,2,2", "--rays", "20000"}).status, 0);
    const Json complete =
        Json::parse(run_earshot({"pvs", "show", path("rooms.pvs"), "--json"}).out);
    // All of the room is found: none of 65536 fresh rays is missed, which bounds the share.
    EXPECT_EQ(complete["missed_share"], 0.0);
    EXPECT_EQ(complete["validation_rays"], 65536);
    EXPECT_EQ(complete["confidence"], 0.95);
    EXPECT_NEAR(complete["missed_share_upper"].get<double>(), 2.9957 / 65536, 1e-9);
    const RunResult text = run_earshot({"pvs", "show", path("rooms.pvs")});
    EXPECT_NE(text.out.find("at most 4.6e-05 (95 % confidence; 0 of 65536 rays)"),
              std::string::npos)
        << text.out;
    // Two rays find two triangles at most, of twelve that cover the sphere.
    const RunResult poor = run_earshot({"pvs",
                                        "build",
                                        path("rooms.obj"),
                                        "--region",
                                        "1.5,1.5,1.5:1.5,1.5,1.5",
                                        "--rays",
                                        "2",
                                        "--validation",
                                        "30000",
                                        "-o",
                                        path("poor.pvs"),
                                        "--json"});
    ASSERT_EQ(poor.status, 0) << poor.err;
    const Json json = Json::parse(poor.out);
    EXPECT_EQ(json["validation_rays"], 30000);
    // Seen from the middle of a cube each of its triangles covers a twelfth of all directions.
    const double missed = 1.0 - json["entries"].get<double>() / 12.0;
    EXPECT_NEAR(json["missed_share"].get<double>(), missed, 0.015);
    EXPECT_GT(json["missed_share_upper"], json["missed_share"]);
}

TEST_F(Pvs, SaysThatNothingIsKnownWithoutValidation) {
    ASSERT_EQ(build({"--region", "1,1,1:2,2,2", "--rays", "2000", "--validation", "0"}).status, 0);
    const Json json = Json::parse(run_earshot({"pvs", "show", path("rooms.pvs"), "--json"}).out);
    EXPECT_TRUE(json["missed_share"].is_null());
    EXPECT_TRUE(json["missed_share_upper"].is_null());
    EXPECT_EQ(json["validation_rays"], 0);
    const RunResult text = run_earshot({"pvs", "show", path("rooms.pvs")});
    EXPECT_NE(text.out.find("missed     not known"), std::string::npos) << text.out;
}

// Runs that told 0 although sets lacked a good part.
TEST_F(Pvs, TellsWhatShortRunsMiss) {
    const std::string city = source_file("scenes/city.gltf").string();
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{"--region", "126,1,126:130,3,130", "--rays", "10000"},
          std::vector<std::string>{"--region", "126,1,126:130,3,130", "--rays", "30000"},
          std::vector<std::string>{"--region",
                                   "1,1,1:239,3,239",
                                   "--grid",
                                   "8,2,8",
                                   "--objects",
                                   "32",
                                   "--rays",
                                   "100000"}}) {
        std::vector<std::string> command{
            "pvs", "build", city, "-o", path("city.pvs"), "--json", "--quiet"};
        command.insert(command.end(), options.begin(), options.end());
        const RunResult result = run_earshot(command);
        ASSERT_EQ(result.status, 0) << result.err;
        const Json json = Json::parse(result.out);
        EXPECT_GT(json["missed_share"], 0.0);
        EXPECT_GT(json["missed_share_upper"], json["missed_share"]);
    }
}

TEST_F(Pvs, WarnsOfSourcesOutsideOfTheRegion) {
    ASSERT_EQ(build({"--region", "0.5,0.5,0.5:1.5,1.5,1.5", "--rays", "20000"}).status, 0);
    const auto ir = [&](const std::vector<std::string>& sources) {
        std::vector<std::string> command{"ir",
                                         path("rooms.obj"),
                                         "-o",
                                         path("out"),
                                         "--listener",
                                         "2,2,2",
                                         "--order",
                                         "1",
                                         "--rays",
                                         "0",
                                         "--visibility",
                                         path("rooms.pvs"),
                                         "--json"};
        for (const std::string& source : sources) {
            command.insert(command.end(), {"--source", source});
        }
        return run_earshot(command);
    };
    const std::string warning = "lies outside of the region of the sets";
    EXPECT_EQ(ir({"in=1,1,1"}).err.find(warning), std::string::npos);
    const RunResult one = ir({"in=1,1,1", "out=2.5,1,1"});
    EXPECT_EQ(one.status, 0);
    EXPECT_NE(one.err.find("source \"out\" " + warning), std::string::npos) << one.err;
    EXPECT_EQ(one.err.find("source \"in\""), std::string::npos);
    // On the region's boundary is inside.
    EXPECT_EQ(ir({"edge=1.5,1.5,1.5"}).err.find(warning), std::string::npos);
    const RunResult both = ir({"high=1,2.9,1", "far=1,1,2.9"});
    EXPECT_NE(both.err.find("source \"high\" " + warning), std::string::npos);
    EXPECT_NE(both.err.find("source \"far\" " + warning), std::string::npos);
}

// Whatever is wrong with the input, an output that cannot be written is told first.
TEST_F(Pvs, ChecksItsOutputBeforeTheWork) {
    const std::string nowhere = path("no/such/file");
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"pvs", "build", path("absent.obj"), "-o", nowhere},
          std::vector<std::string>{
              "pvs", "extract", path("absent.pvs"), "--cells", "1", "-o", nowhere},
          std::vector<std::string>{
              "pvs", "query", path("absent.pvs"), "--at", "1,1,1", "-o", nowhere},
          std::vector<std::string>{
              "los", path("absent.obj"), "--from", "1,1,1", "--to", "2,2,2", "-o", nowhere},
          std::vector<std::string>{"visible", path("absent.obj"), "--from", "1,1,1", "-o", nowhere},
          std::vector<std::string>{
              "visible", path("absent.obj"), "--from", "1,1,1", "--image", nowhere + ".png"},
          std::vector<std::string>{"collide", path("absent.obj"), "-o", nowhere},
          std::vector<std::string>{"ccd", path("absent.csv"), "--kind", "edge-edge", "-o", nowhere},
          std::vector<std::string>{
              "auralize", path("absent.wav"), path("absent.wav"), "-o", nowhere},
          std::vector<std::string>{
              "bvh", path("absent.obj"), "--frames", "0:1:1", "--plot", nowhere + ".svg"}}) {
        EXPECT_TRUE(failed_with(run_earshot(command), 1, "cannot be written")) << command[0];
    }
    std::ofstream(path("file")) << "x";
    EXPECT_TRUE(failed_with(
        run_earshot({"pvs", "build", path("absent.obj"), "-o", path("")}), 1, "is a directory"));
    EXPECT_TRUE(
        failed_with(run_earshot({"pvs", "build", path("absent.obj"), "-o", path("file/in.pvs")}),
                    1,
                    "cannot be written"));
}

TEST_F(Pvs, StopsAfterSeconds) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(build({"--cells", "20000", "--rays", "100000000000", "--seconds", "0.3"}).status, 0);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 20.0);  // without the limit: hours
    const Json json = Json::parse(run_earshot({"pvs", "show", path("rooms.pvs"), "--json"}).out);
    EXPECT_LT(json["cells"], 20000);
    EXPECT_GT(json["missed_share_upper"], 0.0);
}

TEST_F(Pvs, SaysInOneLineWhatIsWrong) {
    struct Case {
        std::vector<std::string> extra;
        int status;
        std::string says;
    };
    for (const Case& c : {Case{{"--region", "1,1:2,2,2"}, 2, "is not of the form X,Y,Z:X,Y,Z"},
                          Case{{"--region", "2,2,2:1,1,1"}, 1, "not in order"},
                          Case{{"--grid", "2,0,1"}, 2, "is not of the form NX,NY,NZ"},
                          Case{{"--grid", "2.5,1,1"}, 2, "is not of the form NX,NY,NZ"},
                          Case{{"--grid", "2,1,1", "--cells", "3"}, 2, "--grid"},
                          Case{{"--rays", "0"}, 2, "--rays"},
                          Case{{"--cells", "9", "--region", "1,1,1:2,1,2"}, 1, "volume"}}) {
        const RunResult result = build(c.extra, "none.pvs");
        EXPECT_EQ(result.status, c.status) << c.says;
        EXPECT_NE(result.err.find(c.says), std::string::npos) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_FALSE(std::ifstream(path("none.pvs")).is_open());
    }
    EXPECT_EQ(run_earshot({"pvs"}).status, 2);
    EXPECT_NE(run_earshot({"pvs", "biuld"}).err.find("did you mean build?"), std::string::npos);
    EXPECT_EQ(run_earshot({"pvs", "show", path("rooms.obj")}).status, 1);
    EXPECT_EQ(run_earshot({"pvs", "show", path("missing")}).status, 1);
    EXPECT_EQ(run_earshot({"pvs", "extract", path("rooms.obj"), "-o", "x"}).status, 2);
    EXPECT_EQ(build({}, "no/such/folder").status, 1);
}

}  // namespace
}  // namespace earshot::test
