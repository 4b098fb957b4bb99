// SPDX-License-Identifier: MIT
// Names are text: whatever a scene calls its parts, nothing is obeyed by a terminal, breaks a
// format, or writes outside of the folder that was asked for.
#include "earshot/io/report_page.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/gltf_builder.h"
#include "support/temporary_folder.h"
#include <fstream>
#include <iterator>
#include <set>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kEscape = "\x1b[31mred\x1b]0;title\x07";
const std::string kLines = "one\ntwo\r\ttab, comma; \"quotes\" 'more' \\ \x7f";
const std::string kMarkup = "</script><img src=x onerror=alert(1)>&amp;<!--";
const std::string kC1 =
    "\xC2\x9B"
    "31m\xE2\x80\xAE"
    "rtl";
const std::string kPath = "../../../../escape/../../x";
const std::string kLong(300, 'n');

/// A box of 4 x 3 x 5 m with names that mean harm, a source and listeners in it.
std::string hostile_scene(const std::vector<std::string>& more_listeners = {}) {
    GltfBuilder builder;
    std::vector<float> corners;
    for (int i = 0; i < 8; ++i) {
        corners.insert(
            corners.end(),
            {(i & 1) != 0 ? 4.0F : 0.0F, (i & 2) != 0 ? 3.0F : 0.0F, (i & 4) != 0 ? 5.0F : 0.0F});
    }
    const int positions = builder.add_accessor<float>("VEC3", corners);
    const int indices = builder.add_accessor<std::uint16_t>(
        "SCALAR", {0, 1, 2, 2, 1, 3, 4, 6, 5, 5, 6, 7, 0, 4, 1, 1, 4, 5,
                   2, 3, 6, 6, 3, 7, 0, 2, 4, 4, 2, 6, 1, 5, 3, 3, 5, 7});
    builder.add_node({{"mesh", builder.add_mesh(positions, indices)}, {"name", kMarkup}});
    builder.primitive(0)["material"] = 0;
    builder.json["materials"] = {{{"name", kEscape + kLines + kC1 + kMarkup}}};
    builder.json["extensionsUsed"] = {"EVIL_\x1b[2J" + kLines};
    double x = 0.5;
    const auto add = [&](const std::string& name, const char* role) {
        builder.add_node({{"name", name},
                          {"translation", {x += 0.3, 1.2, 2.0}},
                          {"extras", {{"acoustics", {{"role", role}, {"a\x1bkey", 1}}}}}});
    };
    add(kEscape + kPath, "source");
    add(kLines, "listener");
    add(kMarkup + kC1, "listener");
    add(kPath, "listener");
    add("..", "listener");
    add(kLong + "a", "listener");
    for (const std::string& name : more_listeners) {
        add(name, "listener");
    }
    const int times = builder.add_accessor<float>("SCALAR", {0.0F, 1.0F});
    const int slide = builder.add_accessor<float>("VEC3", {0, 0, 0, 0.5F, 0, 0});
    builder.json["animations"] = Json::array();
    builder.add_animation(0, "translation", times, slide, "LINEAR");
    builder.json["animations"][0]["name"] = kEscape;
    return builder.gltf();
}

void expect_harmless(const std::string& text, const std::string& what) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto code = static_cast<unsigned char>(text[i]);
        const bool is_control = (code < 0x20 && code != '\n') || code == 0x7f;
        const bool is_c1 =
            code == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
        const bool is_direction = text.compare(i, 3, "\xE2\x80\xAE") == 0;
        ASSERT_FALSE(is_control || is_c1 || is_direction)
            << what << ", byte " << i << ": " << text.substr(i < 40 ? 0 : i - 40, 80);
    }
}

std::string contents(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::set<fs::path> files_below(const fs::path& folder) {
    std::set<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            files.insert(entry.path());
        }
    }
    return files;
}

class HostileNames : public testing::Test {
protected:
    /// Runs a command and returns what it printed, if that is harmless.
    RunResult run(std::vector<std::string> arguments, int status = 0) {
        const std::string command = arguments.front();
        RunResult result = run_earshot(std::move(arguments));
        EXPECT_EQ(result.status, status) << command << ": " << result.err;
        expect_harmless(result.out, command + " standard output");
        expect_harmless(result.err, command + " standard error");
        return result;
    }

    std::string out(const std::string& name) const { return (folder_.path() / name).string(); }

    Json json_file(const std::string& name) const {
        const std::string text = contents(out(name));
        expect_harmless(text, name);
        return Json::parse(text);
    }

    TemporaryFolder folder_;
    const std::string scene_ =
        folder_.file("scene\x1b[7m\n<b>\"',; \xC2\x9B.gltf", hostile_scene()).string();
};

TEST_F(HostileNames, StayWithinTheFolderOfResponses) {
    const std::set<fs::path> before = files_below(folder_.path());
    for (const char* more : {"--quiet", "--json"}) {
        const RunResult result = run({"ir",
                                      scene_,
                                      "-o",
                                      out("results"),
                                      "--order",
                                      "1",
                                      "--rays",
                                      "0",
                                      "--length",
                                      "0.05",
                                      more});
        if (std::string(more) == "--json") {
            EXPECT_TRUE(Json::accept(result.out)) << result.out;
        }
    }
    run({"ir", scene_, "-o", out("results"), "--order", "1", "--rays", "100", "--length", "0.05"});
    std::size_t sounds = 0;
    for (const fs::path& file : files_below(folder_.path())) {
        if (before.count(file) == 0) {
            EXPECT_EQ(file.parent_path(), folder_.path() / "results") << file;
            sounds += file.extension() == ".wav" ? 1 : 0;
        }
    }
    EXPECT_EQ(sounds, 5U);
    const Json paths = json_file("results/paths.json");
    EXPECT_EQ(paths["pairs"][0]["source"], kEscape + kPath);
    EXPECT_EQ(paths["pairs"][0]["listener"], kLines);
    EXPECT_EQ(paths["pairs"][1]["listener"], kMarkup + kC1);
    EXPECT_EQ(paths["pairs"][4]["listener"], kLong + "a");
    json_file("results/metrics.json");
}

TEST_F(HostileNames, ThatGiveOneFileAreRefusedBeforeAnythingIsWritten) {
    // Names of files keep 80 characters.
    const std::string scene = folder_.file("two.gltf", hostile_scene({kLong + "b"})).string();
    const RunResult result = run({"ir", scene, "-o", out("two"), "--order", "1"}, 1);
    EXPECT_NE(result.err.find("would hold the response of two pairs"), std::string::npos);
    EXPECT_FALSE(fs::exists(out("two/paths.json")));
}

TEST_F(HostileNames, AreTextInReports) {
    run({"ir", scene_, "-o", out("results"), "--order", "1", "--rays", "100", "--length", "0.05"});
    run({"report", out("results"), scene_, "-o", out("data.json")});
    const Json data = json_file("data.json");
    EXPECT_EQ(data["sources"][0]["name"], kEscape + kPath);
    EXPECT_EQ(data["listeners"][1]["name"], kMarkup + kC1);
    EXPECT_EQ(data["materials"][0]["name"], kEscape + kLines + kC1 + kMarkup);
    expect_harmless(contents(out("data.json")), "data.json");
    if (io::has_report_page()) {
        run({"report", out("results"), scene_, "-o", out("page.html")});
        const std::string page = contents(out("page.html"));
        EXPECT_EQ(page.find("<img src=x"), std::string::npos);
        EXPECT_EQ(page.find("alert(1)>"), std::string::npos);
    }
}

TEST_F(HostileNames, DoNothingInGeometricCommands) {
    run({"bvh", scene_});
    run({"bvh", scene_, "--frames", "0:1:0.5", "--plot", out("ages.svg")});
    EXPECT_TRUE(Json::accept(run({"bvh", scene_, "--json"}).out));
    expect_harmless(contents(out("ages.svg")), "ages.svg");
    run({"los", scene_, "--from", "1,1,1", "--to", "2,1,1", "-o", out("los.json")});
    EXPECT_EQ(json_file("los.json")["frames"][0]["visible"][0][0], 1);
    run({"visible", scene_, "--from", "1,1,1", "-o", out("visible.json"), "--resolution", "5"});
    EXPECT_EQ(json_file("visible.json")["frames"][0]["materials"][0]["material"],
              kEscape + kLines + kC1 + kMarkup);
    run({"visible", scene_, "--from", "1,1,1", "-o", out("visible.csv"), "--json"});
    run({"pvs", "build", scene_, "-o", out("sets.pvs"), "--rays", "2000"});
    run({"pvs", "show", out("sets.pvs")});
    run({"pvs", "show", out("sets.pvs"), "--json"});
    run({"collide", scene_, "--frames", "0:1:0.5", "-o", out("contacts.json")});
    json_file("contacts.json");
}

TEST_F(HostileNames, AreShownEscapedInErrors) {
    const RunResult material =
        run({"visible", scene_, "--from", "1,1,1", "--ignore", kEscape + kLines}, 1);
    EXPECT_EQ(std::count(material.err.begin(), material.err.end(), '\n'), 1) << material.err;
    run({"materials", kEscape}, 2);
    run({"bvh", scene_, "--animation", kEscape + "no"}, 1);
    run({"bvh", out("absent\x1b[31m.gltf")}, 1);
    run({"los", scene_, "--from", kEscape, "--to", "1,1,1", "-o", out("los.csv")}, 1);
    run({"metrics", out("absent\x1b[31m.wav")}, 1);
    run({"auralize", out("\x1b.wav"), out("b.wav"), "-o", out("c.wav")}, 1);
    run({"ccd", out("absent\x1b.csv"), "--kind", "edge-edge", "-o", out("o.csv")}, 1);
    run({"pvs", "show", out("absent\x1b.pvs")}, 1);
}

TEST_F(HostileNames, InMeshFilesAreTextToo) {
    const std::string mesh = folder_
                                 .file("m\x1b.obj",
                                       "# units: mm\x1b[31m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl " +
                                           kEscape + "\xff\nf 1 2 3\nf 1 2\n")
                                 .string();
    run({"bvh", mesh});
    run({"visible", mesh, "--from", "0.2,0.2,1", "-o", out("m.json")});
    EXPECT_EQ(json_file("m.json")["frames"][0]["materials"][0]["material"],
              kEscape + "\xEF\xBF\xBD");
    const std::string broken =
        folder_.file("b.ply", "ply\nformat ascii 1.0\n\x1b[31mred \n").string();
    run({"bvh", broken}, 1);
}

}  // namespace
}  // namespace earshot::test
