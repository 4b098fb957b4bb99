// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/picture.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

constexpr double kSphere = 4.0 * 3.14159265358979323846;

/// A cube of 2 m around the origin, whose wall at z = -1 has a pane before it.
class Visible : public testing::Test {
protected:
    Visible() {
        std::ofstream(path("room.obj")) << "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 "
                                           "1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                                           "v -1 -1 -0.5\nv 1 -1 -0.5\nv 1 1 -0.5\nv -1 1 -0.5\n"
                                           "usemtl brick\nf 1 2 3\nf 1 3 4\n"      // z = -1
                                           "usemtl floor\nf 1 6 2\nf 1 5 6\n"      // y = -1
                                           "usemtl ceiling\nf 4 3 7\nf 4 7 8\n"    // y = 1
                                           "usemtl left\nf 1 4 8\nf 1 8 5\n"       // x = -1
                                           "usemtl right\nf 2 6 7\nf 2 7 3\n"      // x = 1
                                           "usemtl back\nf 5 8 7\nf 5 7 6\n"       // z = 1
                                           "usemtl pane\nf 9 10 11\nf 9 11 12\n";  // z = -0.5
    }

    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    std::string text_of(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    RunResult run(const std::vector<std::string>& extra, const std::string& from = "0,0,0") const {
        std::vector<std::string> command{"visible", path("room.obj"), "--from", from};
        command.insert(command.end(), extra.begin(), extra.end());
        return run_earshot(command);
    }

    const TemporaryFolder folder_;
};

TEST_F(Visible, WritesATableOfTriangles) {
    const RunResult result =
        run({"--ignore", "pane", "--no-refinement", "-o", path("seen.csv"), "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");
    std::istringstream lines(text_of("seen.csv"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "triangle,pixels,solid_angle,x,y,z");
    double sum = 0.0;
    for (int id = 0; id < 12; ++id) {
        int triangle = -1;
        char comma = ',';
        double pixels = 0.0, angle = 0.0, x = 0.0, y = 0.0, z = 0.0;
        lines >> triangle >> comma >> pixels >> comma >> angle >> comma >> x >> comma >> y >>
            comma >> z;
        EXPECT_EQ(triangle, id);
        EXPECT_GT(pixels, 0.0);
        EXPECT_NEAR(std::sqrt(x * x + y * y + z * z), 1.0, 1e-15);
        sum += angle;
    }
    EXPECT_NEAR(sum, kSphere, 1e-9);
    std::getline(lines, line);
    EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(Visible, WritesJsonWithSharesOfMaterials) {
    const RunResult result = run({"-o", path("seen.json"), "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(text_of("seen.json"));
    EXPECT_EQ(json["version"], 1);
    EXPECT_EQ(json["scene"], "room.obj");
    EXPECT_EQ(json["point"], Json::parse("[0.0,0.0,0.0]"));
    EXPECT_NEAR(json["resolution"].get<double>(), 0.5, 1e-12);
    ASSERT_EQ(json["frames"].size(), 1U);
    const Json& frame = json["frames"][0];
    // The wall behind the pane is the only one that is not seen.
    std::set<int> ids;
    for (const Json& triangle : frame["triangles"]) {
        ids.insert(triangle["triangle"].get<int>());
    }
    EXPECT_EQ(ids, (std::set<int>{2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}));
    const Json summary = Json::parse(result.out);
    EXPECT_EQ(summary["triangles"], 12);
    EXPECT_EQ(summary["complete"], true);
    EXPECT_EQ(summary["rays"], frame["rays"]);
    EXPECT_NEAR(summary["free"].get<double>(), 0.0, 1e-12);
    // At half the distance the pane covers 4 atan(1 / (0.5 sqrt(2.25))) = 3.709 sr.
    const double pane = 4.0 * std::atan(1.0 / (0.5 * std::sqrt(2.25)));
    EXPECT_EQ(summary["materials"][0]["material"], "pane");
    EXPECT_EQ(summary["materials"][0]["triangles"], 2);
    EXPECT_NEAR(summary["materials"][0]["share"].get<double>() * kSphere, pane, 0.01);
    double sum = 0.0;
    for (const Json& material : frame["materials"]) {
        sum += material["solid_angle"].get<double>();
        const bool is_whole = material["material"] == "back";
        if (is_whole) {
            EXPECT_NEAR(material["solid_angle"].get<double>(), kSphere / 6.0, 1e-9);
        }
    }
    EXPECT_NEAR(sum, kSphere, 1e-9);
}

TEST_F(Visible, PrintsASummaryWithoutAFile) {
    const RunResult result = run({});
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.out.find("12 of 14 are seen"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("pane"), std::string::npos);
    EXPECT_EQ(result.out.find("brick"), std::string::npos);
    const RunResult none = run({"--ignore", "pane", "--ignore", "brick"});
    EXPECT_NE(none.out.find("16.67 %             (nothing)"), std::string::npos) << none.out;
}

TEST_F(Visible, WarnsOnASurface) {
    const RunResult result = run({"--json"}, "0.5,-1,0.25");
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.err.find("warning: 0.5,-1,0.25: lies on triangle"), std::string::npos)
        << result.err;
    EXPECT_EQ(run({"--json"}, "0.5,-0.9,0.25").err.find("lies on"), std::string::npos);
}

TEST_F(Visible, PaintsAPanorama) {
    const RunResult result =
        run({"--image", path("seen.png"), "--image-size", "200", "--colour", "material", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const ReadPicture picture = read_picture(path("seen.png"));
    ASSERT_EQ(picture.width, 200U);
    ASSERT_EQ(picture.height, 100U);
    // Where a wall is seen at a right angle its colour is the one that the summary names.
    const Json materials = Json::parse(result.out)["materials"];
    const auto named = [&](const std::string& name) {
        for (const Json& material : materials) {
            if (material["material"] == name) {
                const auto text = material["colour"].get<std::string>();
                return std::array<int, 3>{std::stoi(text.substr(1, 2), nullptr, 16),
                                          std::stoi(text.substr(3, 2), nullptr, 16),
                                          std::stoi(text.substr(5, 2), nullptr, 16)};
            }
        }
        return std::array<int, 3>{-1, -1, -1};
    };
    const auto expect_near = [&](std::size_t column, std::size_t row, const std::string& name) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(picture.at(column, row)[k], named(name)[k], 1) << name;
        }
    };
    expect_near(100, 50, "pane");
    expect_near(150, 50, "right");
    expect_near(50, 50, "left");
    expect_near(0, 50, "back");
    expect_near(100, 0, "ceiling");
    expect_near(100, 99, "floor");
}

TEST_F(Visible, PaintsAView) {
    const auto paint = [&](std::vector<std::string> extra) {
        extra.insert(extra.end(), {"--quiet", "--image", path("seen.png")});
        EXPECT_EQ(run(extra).status, 0);
        return read_picture(path("seen.png"));
    };
    // The two triangles of the pane meet along the line from lower left to upper right.
    const ReadPicture pane = paint({"--look-at", "0,0,-0.5", "--image-size", "40x40"});
    EXPECT_NE(pane.at(30, 20), pane.at(20, 10));
    EXPECT_EQ(pane.at(30, 20), pane.at(20, 30));
    EXPECT_EQ(pane.at(10, 20), pane.at(20, 10));
    const ReadPicture usual = paint({"--field-of-view", "60"});
    EXPECT_EQ(usual.width, 1024U);
    EXPECT_EQ(usual.height, 768U);
    // 255 - 240 d / range: 0.5 m straight ahead, 1 m to the right.
    const auto depth_to = [&](const std::string& target) {
        return paint({"--colour",
                      "depth",
                      "--depth-range",
                      "2",
                      "--image-size",
                      "5x5",
                      "--look-at",
                      target,
                      "--field-of-view",
                      "1"})
            .at(2, 2);
    };
    EXPECT_EQ(depth_to("0,0,-1"), (std::array{195, 195, 195}));
    EXPECT_EQ(depth_to("1,0,0"), (std::array{135, 135, 135}));
    // Without a range the farthest is 15, and where nothing is seen it is black.
    const ReadPicture far = paint({"--colour", "depth", "--ignore", "pane", "--ignore", "brick"});
    int least = 255;
    for (const std::uint8_t part : far.rgb) {
        least = part > 0 ? std::min<int>(least, part) : least;
    }
    EXPECT_EQ(least, 15);
    EXPECT_EQ(far.at(512, 256), (std::array{0, 0, 0}));
}

TEST_F(Visible, FollowsAnAnimationFrameByFrame) {
    const std::string door = test::source_file("scenes/door.gltf").string();
    const auto run_with = [&](const std::vector<std::string>& extra) {
        std::vector<std::string> command{
            "visible", door, "--from", "1,1.5,1", "--resolution", "5", "--quiet"};
        command.insert(command.end(), extra.begin(), extra.end());
        return run_earshot(command).status;
    };
    ASSERT_EQ(run_with({"--frames",
                        "0:1:0.5",
                        "-o",
                        path("all.csv"),
                        "--image",
                        path("all.png"),
                        "--image-size",
                        "64"}),
              0);
    ASSERT_EQ(run_with({"--frames", "0:1:0.5", "-o", path("all.json")}), 0);
    ASSERT_EQ(run_with({"--time",
                        "1",
                        "-o",
                        path("one.csv"),
                        "--image",
                        path("one.png"),
                        "--image-size",
                        "64"}),
              0);
    EXPECT_EQ(text_of("all__0002.csv"), text_of("one.csv"));
    EXPECT_EQ(text_of("all__0002.png"), text_of("one.png"));
    EXPECT_NE(text_of("all__0000.csv"), "");
    const Json frames = Json::parse(text_of("all.json"))["frames"];
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[2]["time"], 1.0);
}

TEST_F(Visible, SaysWhatIsWrong) {
    const auto expect = [&](const std::vector<std::string>& extra, int status, const char* part) {
        EXPECT_TRUE(failed_with(run(extra), status, part)) << part;
    };
    EXPECT_TRUE(failed_with(run({}, "1,2"), 2, "not of the form X,Y,Z"));
    EXPECT_TRUE(failed_with(run({}, "1,2,nan"), 2, "not of the form X,Y,Z"));
    expect({"--resolution", "0"}, 2, "--resolution");
    expect({"--resolution", "fine"}, 2, "--resolution");
    expect({"--quiet"}, 2, "nothing to do");
    expect({"--colour", "heat"}, 2, "--colour");
    expect({"--image-size", "10x"}, 2, "--image-size");
    expect({"--image-size", "100000"}, 2, "--image-size");
    expect({"--look-at", "0,0,0"}, 2, "--look-at");
    expect({"--field-of-view", "180"}, 2, "--field-of-view");
    expect({"--ignore", "brik"}, 1, "did you mean brick?");
    expect({"-o", path("no/seen.csv")}, 1, "cannot be written");
    expect({"--image", path("no/seen.png")}, 1, "cannot be written");
    EXPECT_TRUE(failed_with(
        run_earshot({"visible", path("absent.obj"), "--from", "0,0,0"}), 1, "no such file"));
    EXPECT_TRUE(failed_with(run_earshot({"visible", path("room.obj")}), 2, "--from"));
}

}  // namespace
}  // namespace earshot::test
