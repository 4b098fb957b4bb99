// SPDX-License-Identifier: MIT
// What `earshot ir --diffraction` writes.
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"

namespace earshot::test {
namespace {

using Json = nlohmann::json;

TEST(IrDiffraction, BendsRoundTheCornerOfAnLRoom) {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "out").string();
    const std::string lroom = test::source_file("scenes/lroom.gltf").string();
    const auto paths_with = [&](const char* diffraction) {
        EXPECT_EQ(run_earshot({"ir",
                               lroom,
                               "-o",
                               out,
                               "--order",
                               "0",
                               "--diffraction",
                               diffraction,
                               "--rays",
                               "0",
                               "--quiet"})
                      .status,
                  0);
        const Json file = Json::parse(read_file(folder.path() / "out" / "paths.json"));
        Json paths = Json::array();
        for (const Json& pair : file["pairs"]) {
            for (const Json& path : pair["paths"]) {
                paths.push_back(path);
            }
        }
        return paths;
    };
    std::size_t direct = 0;
    std::size_t diffracted = 0;
    for (const Json& path : paths_with("1")) {
        direct += path["kind"] == "direct" ? 1 : 0;
        EXPECT_EQ(path.contains("edges"), path["kind"] == "diffracted");
        if (path["kind"] == "diffracted") {
            ++diffracted;
            EXPECT_EQ(path["order"], 1);
            EXPECT_EQ(path["points"].size(), 3U);
            ASSERT_EQ(path["edges"].size(), 1U);
            EXPECT_EQ(path["edges"][0].size(), 2U);
            EXPECT_EQ(path["triangles"].size(), 1U);
        }
    }
    EXPECT_EQ(paths_with("0").size(), direct);
    EXPECT_GT(diffracted, 0U);
    EXPECT_EQ(run_earshot({"ir", lroom, "-o", out, "--diffraction", "3"}).status, 2);
}

TEST(IrDiffraction, TellsOfPairsThatItWouldReach) {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "out").string();
    const auto notes_of = [&](const char* scene, const char* diffraction) {
        const auto result = run_earshot({"ir",
                                         test::source_file(scene).string(),
                                         "-o",
                                         out,
                                         "--order",
                                         "0",
                                         "--diffraction",
                                         diffraction,
                                         "--rays",
                                         "0",
                                         "--no-metrics",
                                         "--json"});
        EXPECT_EQ(result.status, 0);
        std::size_t told = 0;
        const Json summary = Json::parse(result.out);
        for (const Json& note : summary["notes"]) {
            const std::string text = note["text"];
            told += text.find("no direct path") != std::string::npos ? 1 : 0;
            EXPECT_NE(result.err.find(text), std::string::npos);
        }
        return told;
    };
    EXPECT_EQ(notes_of("scenes/lroom.gltf", "0"), 1U);
    EXPECT_EQ(notes_of("scenes/lroom.gltf", "1"), 0U);
    EXPECT_EQ(notes_of("scenes/shoebox.gltf", "0"), 0U);
}

}  // namespace
}  // namespace earshot::test
