// SPDX-License-Identifier: MIT
// Report pages: what goes into one, and that nothing else does. The data is looked at through
// `-o data.json`, which every build has; pages where the page itself is built.
#include "earshot/io/report_page.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <fstream>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string scene(const std::string& name) {
    return test::source_file("scenes/" + name).string();
}

class Report : public testing::Test {
protected:
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    /// `earshot ir` of the shoe-box into a folder.
    RunResult run_ir(const std::string& folder, std::vector<std::string> more = {}) const {
        std::vector<std::string> arguments{"ir",
                                           scene("shoebox.gltf"),
                                           "-o",
                                           path(folder),
                                           "--order",
                                           "2",
                                           "--rays",
                                           "8192",
                                           "--histograms",
                                           "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }

    Json report_of(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "report");
        arguments.insert(arguments.end(), {"-o", path("data.json"), "--quiet"});
        const RunResult result = run_earshot(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        return Json::parse(read_file(path("data.json")), nullptr, false);
    }

    TemporaryFolder folder_;
};

TEST_F(Report, ShowsResultsInTheirRoom) {
    ASSERT_EQ(run_ir("out").status, 0);
    const Json data = report_of({path("out"), scene("shoebox.gltf"), "--limit", "sti=0.99"});
    EXPECT_EQ(data["kind"], "rooms");
    EXPECT_EQ(data["title"], "shoebox");
    ASSERT_EQ(data["pairs"].size(), 1U);
    const Json metrics = Json::parse(read_file(path("out/metrics.json")));
    const Json paths = Json::parse(read_file(path("out/paths.json")));
    EXPECT_EQ(data["pairs"][0]["metrics"], metrics["pairs"][0]);
    EXPECT_EQ(data["pairs"][0]["paths"], paths["pairs"][0]["paths"]);
    EXPECT_EQ(data["room"]["volume"], metrics["room"]["volume"]);
    EXPECT_TRUE(data.contains("scene") && data.contains("materials"));
    EXPECT_EQ(data["verdict"].back()["state"], "missed");
    // The line of T30 has its slope: 60 dB in T30 seconds.
    const Json& line = data["pairs"][0]["decay"]["fits"][5]["t30"];
    const double time = 60.0 * (line["to"].get<double>() - line["from"].get<double>()) /
                        (line["level_from"].get<double>() - line["level_to"].get<double>());
    const double t30 = metrics["pairs"][0]["t30"][5].get<double>();
    EXPECT_NEAR(time, t30, 1e-3 * t30);  // levels are told in hundredths
}

TEST_F(Report, OfAFolderAloneHasNoWalls) {
    ASSERT_EQ(run_ir("out").status, 0);
    const Json data = report_of({path("out")});
    EXPECT_EQ(data["title"], "out");
    EXPECT_FALSE(data.contains("scene"));
    EXPECT_FALSE(data["sources"][0]["position"].is_null());
}

TEST_F(Report, ComparesWithAnotherRun) {
    ASSERT_EQ(run_ir("before", {"--material", "*=acoustic-tile-suspended"}).status, 0);
    ASSERT_EQ(run_ir("after").status, 0);
    const Json before = Json::parse(read_file(path("before/metrics.json")));
    for (const char* const against : {"before", "before/metrics.json"}) {
        const Json data = report_of({path("after"), "--against", path(against)});
        Json reference = data["pairs"][0]["reference"];
        EXPECT_EQ(reference["name"], fs::path(against).filename().string());
        reference.erase("name");
        EXPECT_EQ(reference, before["pairs"][0]);
    }
}

TEST_F(Report, PlaysARecordingAsTheListenerHearsIt) {
    ASSERT_EQ(run_ir("out").status, 0);
    // A response is a recording, too: of a click.
    const Json pair = Json::parse(read_file(path("out/paths.json")))["pairs"][0];
    const std::string response =
        pair["source"].get<std::string>() + "__" + pair["listener"].get<std::string>() + ".wav";
    fs::copy_file(path("out/" + response), path("dry.wav"));
    const Json audio = report_of({path("out"), "--audio", path("dry.wav")})["pairs"][0]["audio"];
    const std::string head = "data:audio/wav;base64,UklGR";  // RIFF
    for (const char* const key : {"dry", "wet"}) {
        EXPECT_EQ(audio[key].get<std::string>().substr(0, head.size()), head);
    }
    // What is heard lasts as long as recording and response together.
    EXPECT_NEAR(static_cast<double>(audio["wet"].get<std::string>().size()),
                2.0 * static_cast<double>(audio["dry"].get<std::string>().size()),
                200.0);
}

TEST_F(Report, NamesNoFolders) {
    ASSERT_EQ(run_ir("out").status, 0);
    const Json data = report_of({path("out"), scene("shoebox.gltf")});
    EXPECT_EQ(data["provenance"]["command"],
              "earshot report out shoebox.gltf -o data.json --quiet");
    EXPECT_EQ(data["provenance"]["files"], Json({"out", "shoebox.gltf"}));
    EXPECT_EQ(read_file(path("data.json")).find(folder_.path().string()), std::string::npos);
}

TEST_F(Report, HasTheSameBytesForAnyNumberOfThreads) {
    std::vector<std::string> data;
    for (const char* const threads : {"1", "3"}) {
        const std::string folder = std::string("out") + threads;
        ASSERT_EQ(run_ir(folder, {"--threads", threads}).status, 0);
        fs::rename(path(folder), path("out"));
        data.push_back(report_of({path("out"), scene("shoebox.gltf")}).dump());
        fs::remove_all(path("out"));
    }
    EXPECT_EQ(data[0], data[1]);
}

TEST_F(Report, ShowsContactsAndTheMeshesThatMove) {
    ASSERT_EQ(run_earshot({"collide",
                           scene("door.gltf"),
                           "--frames",
                           "0:2:0.1",
                           "-o",
                           path("contacts.json"),
                           "--quiet"})
                  .status,
              0);
    const Json contacts = Json::parse(read_file(path("contacts.json")));
    const Json data = report_of({path("contacts.json"), scene("door.gltf")});
    EXPECT_EQ(data["kind"], "contacts");
    const Json& shown = data["contacts"];
    ASSERT_EQ(shown["steps"].size(), contacts["steps"].size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < contacts["steps"].size(); ++i) {
        EXPECT_EQ(shown["steps"][i]["count"], contacts["steps"][i]["contacts"].size());
        count += contacts["steps"][i]["contacts"].size();
    }
    EXPECT_EQ(shown["contacts"].size() + shown["left_out"].get<std::size_t>(), count);
    ASSERT_EQ(shown["meshes"].size(), contacts["meshes"].size());
    bool moves = false;
    for (const Json& mesh : shown["meshes"]) {
        moves = moves || mesh["frames"].size() > 1;
    }
    EXPECT_TRUE(moves);
}

TEST_F(Report, ShowsMapsInTheirRoom) {
    std::vector<std::string> arguments{"map",
                                       scene("shoebox.gltf"),
                                       "--rect",
                                       "1,-3,3,-1",
                                       "--step",
                                       "1",
                                       "--metric",
                                       "sti,c80",
                                       "--limit",
                                       "sti=0.99",
                                       "--rays",
                                       "4096",
                                       "--order",
                                       "1",
                                       "--quiet",
                                       "-o",
                                       path("map.json")};
    ASSERT_EQ(run_earshot(arguments).status, 0);
    const Json map = Json::parse(read_file(path("map.json")));
    const Json data = report_of({path("map.json"), scene("shoebox.gltf")});
    EXPECT_EQ(data["kind"], "map");
    ASSERT_EQ(data["maps"].size(), 2U);
    for (const char* const key : {"points", "values", "errors", "cells", "contour"}) {
        EXPECT_EQ(data["maps"][0][key], map["maps"][0][key]) << key;
    }
    EXPECT_EQ(data["verdict"][0]["state"], "missed");
    EXPECT_TRUE(data.contains("scene"));
    arguments.push_back("--report");
    const RunResult result = run_earshot(arguments);
    EXPECT_EQ(result.status, io::has_report_page() ? 0 : 1) << result.err;
    EXPECT_EQ(fs::exists(path("map.html")), io::has_report_page());
}

TEST_F(Report, OfAWholeRunIsThatOfItsFiles) {
    const RunResult result = run_ir("out", {"--report", "--limit", "sti=0.5"});
    if (!io::has_report_page()) {
        EXPECT_TRUE(failed_with(result, 1, "report/bundle"));
        EXPECT_FALSE(fs::exists(path("out")));
        return;
    }
    ASSERT_EQ(result.status, 0) << result.err;
    const std::string page = read_file(path("out/report.html"));
    const std::string begin = "id=\"report-data\">";
    const std::size_t at = page.find(begin);
    ASSERT_NE(at, std::string::npos);
    const std::size_t first = at + begin.size();
    const Json shown = Json::parse(page.substr(first, page.find("</script>", first) - first));
    EXPECT_EQ(shown["verdict"][3]["question"], "Which surface is worth treating?");
    const Json data = report_of({path("out"), scene("shoebox.gltf"), "--limit", "sti=0.5"});
    for (const char* const key : {"pairs", "scene", "materials", "room", "sources", "listeners"}) {
        EXPECT_EQ(shown[key], data[key]) << key;
    }
    EXPECT_EQ(shown["provenance"]["scene_digest"], data["provenance"]["scene_digest"]);
    EXPECT_EQ(shown["provenance"]["seed"], 1);
}

TEST_F(Report, RefusesInputWithOneLine) {
    ASSERT_EQ(run_ir("out").status, 0);
    const auto expect_refused =
        [&](std::vector<std::string> arguments, int status, const std::string& part) {
            arguments.insert(arguments.begin(), "report");
            arguments.insert(arguments.end(), {"-o", path("data.json")});
            EXPECT_TRUE(failed_with(run_earshot(arguments), status, part));
            EXPECT_FALSE(fs::exists(path("data.json")));
        };
    fs::create_directory(path("empty"));
    const std::string broken = folder_.file("broken.json", "{\"bands_hz\":[").string();
    expect_refused({path("missing")}, 1, "missing");
    expect_refused({path("empty")}, 1, "earshot ir -o");
    expect_refused({broken}, 1, "broken.json");
    expect_refused({path("out"), broken}, 1, "broken.json");
    expect_refused({path("out"), scene("door.gltf"), scene("city.gltf")}, 1, "second scene");
    expect_refused({path("out"), "--limit", "sti"}, 2, "--limit");
    expect_refused({path("out"), "--against", path("empty")}, 1, "metrics.json");
    EXPECT_TRUE(failed_with(run_ir("x", {"--limit", "sti=0.5"}), 2, "--report"));
}

}  // namespace
}  // namespace earshot::test
