// SPDX-License-Identifier: MIT

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

/// earshot ir of a shipped scene, with what takes long left out.
class Plan : public testing::Test {
protected:
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    std::string text_of(const std::string& name) const {
        std::ifstream stream(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    RunResult run(const std::string& scene, const std::vector<std::string>& extra) const {
        std::vector<std::string> command{"ir",
                                         source_file("scenes/" + scene).string(),
                                         "-o",
                                         path("out"),
                                         "--order",
                                         "1",
                                         "--rays",
                                         "0",
                                         "--no-metrics",
                                         "--quiet"};
        command.insert(command.end(), extra.begin(), extra.end());
        return run_earshot(command);
    }

    const TemporaryFolder folder_;
};

TEST_F(Plan, LabelsSourcesListenersAndFirstReflectors) {
    const RunResult result = run("classroom.gltf", {"--plan", path("plan.svg")});
    EXPECT_EQ(result.status, 0) << result.err;
    const std::string svg = text_of("plan.svg");
    EXPECT_EQ(svg.substr(0, 5), "<svg ");
    for (const char* label : {"teacher", "front_left", "middle", "back_right", " ms"}) {
        EXPECT_NE(svg.find(std::string(label) + "</text>"), std::string::npos) << label;
    }
    EXPECT_EQ(run("classroom.gltf", {"--plan", path("again.svg"), "--threads", "3"}).status, 0);
    EXPECT_TRUE(text_of("again.svg") == svg);
}

// One per instant; labels of what does not move stay where they are.
TEST_F(Plan, LabelsStandStillOverFrames) {
    const RunResult result = run("door.gltf", {"--plan", path("door.svg"), "--frames", "0:2:0.5"});
    EXPECT_EQ(result.status, 0) << result.err;
    const std::regex label("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"[^>]*>([a-z_]+)</text>");
    std::map<std::string, std::string> places;
    for (int frame = 0; frame <= 4; ++frame) {
        const std::string svg = text_of("door__000" + std::to_string(frame) + ".svg");
        for (std::sregex_iterator match(svg.begin(), svg.end(), label), end; match != end;
             ++match) {
            const std::string place = (*match)[1].str() + "," + (*match)[2].str();
            EXPECT_EQ(places.emplace((*match)[3], place).first->second, place)
                << (*match)[3] << " " << frame;
        }
    }
    EXPECT_EQ(places.size(), 3U);
    EXPECT_FALSE(std::filesystem::exists(path("door.svg")));
}

TEST_F(Plan, IsRefusedBeforeTheWork) {
    EXPECT_TRUE(failed_with(run("shoebox.gltf", {"--plan", path("plan.png")}), 2, ".svg"));
    EXPECT_TRUE(failed_with(run("shoebox.gltf", {"--plan", path("no/plan.svg")}), 1, "plan.svg"));
    EXPECT_FALSE(std::filesystem::exists(path("out/paths.json")));
}

}  // namespace
}  // namespace earshot::test
