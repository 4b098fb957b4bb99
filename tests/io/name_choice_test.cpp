// SPDX-License-Identifier: MIT
#include "earshot/io/name_choice.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace earshot::io {
namespace {

std::string error_of(const std::vector<std::string>& names, const std::string& name) {
    try {
        find_name("paths.json", names, {.role = "listener", .option = "--listener", .name = name});
    } catch (const Error& error) {
        return error.line();
    }
    return "";
}

TEST(NameChoice, IsTheIndexOfTheName) {
    const std::vector<std::string> names = {"seat", "stage", "seat 2"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        EXPECT_EQ(find_name("paths.json", names, {.role = "listener", .name = names[i]}), i);
    }
}

TEST(NameChoice, NeedsNoNameWhereThereIsOneOnly) {
    EXPECT_EQ(find_name("paths.json", {"seat"}, {.role = "listener"}), 0U);
}

TEST(NameChoice, AsksForTheOptionWhereThereAreSeveral) {
    const std::string error = error_of({"seat", "stage"}, "");
    EXPECT_NE(error.find("paths.json"), std::string::npos) << error;
    EXPECT_NE(error.find("--listener"), std::string::npos) << error;
}

TEST(NameChoice, TellsANameThatIsUnknown) {
    const std::string error = error_of({"seat", "stage"}, "nobody");
    EXPECT_NE(error.find("paths.json"), std::string::npos) << error;
    EXPECT_NE(error.find("listener"), std::string::npos) << error;
    EXPECT_NE(error.find("nobody"), std::string::npos) << error;
}

}  // namespace
}  // namespace earshot::io
