// SPDX-License-Identifier: MIT
#include "earshot/cli/command_line.h"

#include <gtest/gtest.h>

#include <vector>

namespace earshot::cli {
namespace {

TEST(CommandLine, LeavesFoldersOut) {
    const std::vector<const char*> arguments = {"/usr/bin/earshot",
                                                "ir",
                                                "/home/me/secret/room.glb",
                                                "-o",
                                                "out/",
                                                "--hrtf=/x/y.sofa",
                                                "-o/tmp/z",
                                                "--source",
                                                "a=1,2,3",
                                                "/"};
    EXPECT_EQ(command_line_without_folders(arguments),
              "earshot ir room.glb -o out --hrtf=y.sofa -oz --source a=1,2,3 ''");
}

TEST(CommandLine, QuotesWhatAShellWouldTakeApart) {
    const std::vector<const char*> arguments = {
        "earshot", "ir", "my room.glb", "--material", "*=it's", "", "$(x)"};
    EXPECT_EQ(command_line_without_folders(arguments),
              "earshot ir 'my room.glb' --material '*=it'\\''s' '' '$(x)'");
    EXPECT_EQ(command_line_without_folders({}), "earshot");
}

}  // namespace
}  // namespace earshot::cli
