// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <string>
#include <vector>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

/// What a command says of its hierarchy, about a scene of the project.
Json hierarchy_of(const std::string& command,
                  const std::string& scene,
                  const std::vector<std::string>& options) {
    const TemporaryFolder folder;
    std::vector<std::string> words = {command, source_file("scenes/" + scene).string()};
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"-o", (folder.path() / "out.json").string(), "--json"});
    const RunResult result = run_earshot(words);
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out)["hierarchy"];
}

int updates_of(const Json& hierarchy) {
    return hierarchy["refits"].get<int>() + hierarchy["repairs"].get<int>() +
           hierarchy["rebuilds"].get<int>();
}

TEST(UpdateSummary, EveryCommandTellsHowItsHierarchyFollowedTheScene) {
    const std::vector<std::string> frames = {"--frames", "0:0.4:0.1"};
    const auto with_frames = [&](std::vector<std::string> options) {
        options.insert(options.end(), frames.begin(), frames.end());
        return options;
    };
    EXPECT_EQ(updates_of(hierarchy_of(
                  "los", "curtain.gltf", with_frames({"--from", "1,1,1", "--to", "2,2,2"}))),
              4);
    EXPECT_EQ(
        updates_of(hierarchy_of(
            "visible", "curtain.gltf", with_frames({"--from", "1,1,1", "--resolution", "5"}))),
        4);
    EXPECT_GE(updates_of(hierarchy_of("collide", "curtain.gltf", with_frames({"--self"}))), 3);
    EXPECT_GE(
        updates_of(hierarchy_of("collide", "curtain.gltf", with_frames({"--self", "--discrete"}))),
        3);
    const Json of_ir = hierarchy_of(
        "ir", "curtain.gltf", with_frames({"--order", "1", "--rays", "200", "--length", "0.2"}));
    // The triangles are followed at each instant, the facets where they stay the same.
    EXPECT_GE(updates_of(of_ir), 4);
    EXPECT_GE(of_ir["builds"], 2);
    EXPECT_EQ(updates_of(of_ir) + of_ir["builds"].get<int>(), 2 + 2 * 4);
}

TEST(UpdateSummary, ASceneAtRestHasOneHierarchyOfEachKind) {
    const Json of_ir = hierarchy_of(
        "ir", "concert_hall.gltf", {"--order", "1", "--rays", "64", "--length", "0.2"});
    EXPECT_EQ(of_ir["builds"], 2);  // over the triangles, over the facets
    EXPECT_EQ(updates_of(of_ir), 0);
}

}  // namespace
}  // namespace earshot::test
