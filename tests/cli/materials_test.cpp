// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "run_earshot.h"

namespace earshot::test {
namespace {

using Json = nlohmann::json;

Json json_of_all() {
    return Json::parse(run_earshot({"materials", "--json"}).out);
}

Json all_materials() {
    return json_of_all().at("materials");
}

TEST(Materials, JsonHoldsEveryRowInFull) {
    const Json document = json_of_all();
    EXPECT_EQ(document.at("version"), 1);
    const Json& materials = document.at("materials");
    ASSERT_GE(materials.size(), 40U);
    std::string last;
    for (const Json& material : materials) {
        const std::string name = material.at("name");
        EXPECT_LT(last, name);
        last = name;
        EXPECT_FALSE(material.at("description").get<std::string>().empty()) << name;
        EXPECT_FALSE(material.at("source").get<std::string>().empty()) << name;
        EXPECT_FALSE(material.at("scattering_source").get<std::string>().empty()) << name;
        for (const char* coefficient : {"absorption", "scattering", "transmission"}) {
            EXPECT_FALSE(material.at(coefficient).empty()) << name;
            for (const auto& [frequency, value] : material.at(coefficient).items()) {
                EXPECT_GT(std::stod(frequency), 0.0) << name;
                EXPECT_GE(value.get<double>(), 0.0) << name;
                EXPECT_LE(value.get<double>(), 1.0) << name;
            }
        }
    }
}

TEST(Materials, TableNamesEveryRow) {
    const RunResult result = run_earshot({"materials"});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "");
    for (const Json& material : all_materials()) {
        const std::string name = material.at("name");
        EXPECT_NE(result.out.find("\n" + name + " "), std::string::npos) << name;
    }
}

TEST(Materials, OneRowIsShownWithItsSource) {
    const Json first = all_materials().at(0);
    const std::string name = first.at("name");
    const RunResult result = run_earshot({"materials", name});
    EXPECT_EQ(result.status, 0);
    EXPECT_TRUE(result.out.starts_with(name + ": "));
    EXPECT_NE(result.out.find("Source: " + first.at("source").get<std::string>()),
              std::string::npos);
    EXPECT_NE(result.out.find("Scattering: " + first.at("scattering_source").get<std::string>()),
              std::string::npos);
    const Json alone = Json::parse(run_earshot({"materials", name, "--json"}).out);
    EXPECT_EQ(alone.at("materials"), Json::array({first}));
}

TEST(Materials, APartOfANameListsAllThatContainIt) {
    const RunResult result = run_earshot({"materials", "curtain"});
    EXPECT_EQ(result.status, 0);
    std::size_t expected = 0;
    for (const Json& material : all_materials()) {
        const std::string name = material.at("name");
        const bool contains = name.find("curtain") != std::string::npos;
        expected += contains ? 1 : 0;
        EXPECT_EQ(result.out.find("\n" + name + " ") != std::string::npos, contains) << name;
    }
    const Json found = Json::parse(run_earshot({"materials", "curtain", "--json"}).out);
    EXPECT_EQ(found.at("materials").size(), expected);
}

TEST(Materials, NumbersDoNotDependOnTheLocale) {
    const RunResult plain = run_earshot({"materials"});
    const RunResult german =
        run_earshot({"materials"}, {.environment = {{"LC_ALL", "de_DE.UTF-8"}}});
    EXPECT_EQ(german.status, 0);
    EXPECT_EQ(german.out, plain.out);
}

TEST(Materials, UnknownNameGetsASuggestion) {
    std::string name = all_materials().at(0).at("name");
    name.insert(1, "q");
    EXPECT_TRUE(failed_with(run_earshot({"materials", name}), 2, "did you mean "));
    EXPECT_TRUE(failed_with(run_earshot({"materials", "zzzzzzzz"}), 2, "see earshot materials"));
}

}  // namespace
}  // namespace earshot::test
