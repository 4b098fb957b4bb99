// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "support/run_program.h"
#include "support/temporary_folder.h"
#include <filesystem>

namespace earshot::scenes {
namespace {

test::RunResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), EARSHOT_SCENES_PROGRAM);
    return test::run_program(arguments);
}

TEST(ScenesProgram, HelpNamesEveryScene) {
    const test::RunResult result = run({"--help"});
    EXPECT_EQ(result.status, 0);
    for (const char* word : {"shoebox",
                             "lroom",
                             "coupled_rooms",
                             "classroom",
                             "concert_hall",
                             "door",
                             "curtain",
                             "city",
                             "all",
                             "--tessellation"}) {
        EXPECT_NE(result.out.find(word), std::string::npos) << word;
    }
    EXPECT_NE(run({"concert_hall", "--help"}).out.find("--seats"), std::string::npos);
}

TEST(ScenesProgram, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(run({}).status, 2);
    EXPECT_EQ(run({"cathedral"}).status, 2);
    EXPECT_EQ(run({"shoebox"}).status, 2) << "no output asked for";
    EXPECT_EQ(run({"concert_hall", "--seats", "cosy", "-o", "x.gltf"}).status, 2);
    EXPECT_EQ(run({"shoebox", "--tessellation", "0", "-o", "x.gltf"}).status, 2);
    const test::TemporaryFolder folder;
    const test::RunResult suffix = run({"shoebox", "-o", (folder.path() / "shoebox.obj").string()});
    EXPECT_EQ(suffix.status, 1);
    EXPECT_NE(suffix.err.find("name it .gltf or .glb"), std::string::npos);
    EXPECT_EQ(run({"shoebox", "-o", (folder.path() / "no/such/box.glb").string()}).status, 1);
}

TEST(ScenesProgram, WritesScenesByParameters) {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "box.glb";
    const test::RunResult result =
        run({"shoebox", "--size", "5", "3", "4", "--tessellation", "50", "-o", file.string()});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find(": 30000 triangles"), std::string::npos) << result.out;
    EXPECT_TRUE(std::filesystem::remove(file));
}

}  // namespace
}  // namespace earshot::scenes
