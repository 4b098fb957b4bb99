// SPDX-License-Identifier: MIT
#include "earshot/io/material_assignments.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <fstream>

namespace earshot::io {
namespace {

/// All of default data.
LoadedScene scene_with(const std::vector<std::string>& names) {
    LoadedScene loaded;
    for (const std::string& name : names) {
        loaded.default_materials.push_back(
            static_cast<std::uint32_t>(loaded.scene.materials.size()));
        loaded.scene.materials.push_back({.name = name});
    }
    return loaded;
}

double absorption(const propagation::Material& material) {
    return material.absorption.at(1000.0);
}

class MaterialFile : public testing::Test {
protected:
    std::filesystem::path write(const std::string& text) {
        const auto file = folder_.path() / "room.materials.json";
        std::ofstream(file) << text;
        return file;
    }

    std::string error_of(const std::string& text) {
        Warnings warnings;
        try {
            read_material_assignments(write(text), warnings);
        } catch (const Error& error) {
            return error.line();
        }
        return "";
    }

    test::TemporaryFolder folder_;
};

TEST(MaterialAssignments, AnOptionNamesAPatternAndALibraryMaterial) {
    const MaterialAssignment assignment = parse_material_assignment("Brick*=brick-painted");
    EXPECT_EQ(assignment.pattern, "Brick*");
    const auto row = propagation::find_library_material("brick-painted");
    ASSERT_TRUE(row);
    EXPECT_EQ(absorption(assignment.material), absorption(*row));
}

TEST(MaterialAssignments, APatternMayHoldAnEqualsSign) {
    EXPECT_EQ(parse_material_assignment("a=b*=brick-painted").pattern, "a=b*");
}

TEST(MaterialAssignments, RefusesWhatIsNotOfTheForm) {
    for (const char* text : {"brick-painted", "=brick-painted", "Wall=", ""}) {
        EXPECT_THROW(parse_material_assignment(text), Error) << text;
    }
}

TEST(MaterialAssignments, AnUnknownLibraryNameIsToldWithItsNeighbours) {
    try {
        parse_material_assignment("Wall=brick-paintd");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(error.line().find("brick-painted"), std::string::npos) << error.line();
    }
}

TEST_F(MaterialFile, ScatteringNotGivenIsTheDefaultAndZeroStaysZero) {
    Warnings warnings;
    const auto read = read_material_assignments(
        write(R"({"Wall": {"absorption": 0.3}, "Ice": {"absorption": 0.3, "scattering": 0},
                  "Glass": "glass-3mm"})"),
        warnings);
    ASSERT_EQ(read.size(), 3U);
    EXPECT_EQ(read[0].material.scattering.at(500.0), 0.1);
    EXPECT_EQ(read[1].material.scattering.at(500.0), 0.0);
    EXPECT_EQ(read[2].material.scattering.at(500.0), 0.05);
}

TEST(MaterialAssignments, TheLastMatchCounts) {
    LoadedScene loaded = scene_with({"Carpet red", "Carpet blue", "Wall"});
    const std::vector<MaterialAssignment> assignments = {
        {"Carpet*", {.name = "", .absorption = propagation::EnergyCoefficient(0.3)}, "a"},
        {"*blue", {.name = "", .absorption = propagation::EnergyCoefficient(0.5)}, "b"}};
    assign_materials(assignments, loaded);
    EXPECT_TRUE(loaded.acoustic_warnings.empty());
    EXPECT_EQ(loaded.default_materials, std::vector<std::uint32_t>{2});
    const auto& materials = loaded.scene.materials;
    EXPECT_EQ(absorption(materials[0]), 0.3);
    EXPECT_EQ(absorption(materials[1]), 0.5);
    EXPECT_EQ(absorption(materials[2]), 0.1);
    EXPECT_EQ(materials[1].name, "Carpet blue");
}

TEST(MaterialAssignments, MaterialsWithoutDataAreToldInOneWarning) {
    LoadedScene loaded = scene_with({"Carpet", "Wall", "Desk"});
    Warnings warnings = warnings_of_acoustics(loaded);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("\"Carpet\", \"Wall\", \"Desk\""), std::string::npos)
        << warnings[0].what;
    assign_materials({{"*", {}, "option"}}, loaded);
    EXPECT_TRUE(warnings_of_acoustics(loaded).empty());
}

TEST(MaterialAssignments, PatternsAreThoseOfAShell) {
    const struct {
        const char* pattern;
        const char* name;
        bool matches;
    } cases[] = {{"Wall?", "Wall1", true},
                 {"Wall?", "Wall", false},
                 {"Wall[0-9]", "Wall7", true},
                 {"Wall[!0-9]", "Wall7", false},
                 {"*", "anything / at all", true},
                 {"wall", "Wall", false}};
    for (const auto& [pattern, name, matches] : cases) {
        LoadedScene loaded = scene_with({name});
        assign_materials({{pattern, {}, "option"}}, loaded);
        EXPECT_EQ(loaded.default_materials.empty(), matches) << pattern << " " << name;
        EXPECT_EQ(loaded.acoustic_warnings.empty(), matches);
    }
}

TEST(MaterialAssignments, APatternThatMatchesNothingIsAWarningWithTheNamesThereAre) {
    LoadedScene loaded = scene_with({"Floor", "Ceiling"});
    assign_materials({{"Carpet*", {}, "--material"}}, loaded);
    const Warnings& warnings = loaded.acoustic_warnings;
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings[0].subject, "--material");
    EXPECT_NE(warnings[0].what.find("Carpet*"), std::string::npos);
    EXPECT_NE(warnings[0].what.find("Floor, Ceiling"), std::string::npos);
}

TEST_F(MaterialFile, HoldsLibraryNamesAndObjectsInItsOwnOrder) {
    Warnings warnings;
    const auto assignments = read_material_assignments(
        write(R"({"W*": {"absorption": {"125": 0.2, "500": 0.4}, "scattering": 0.3},
                  "A*": "brick-painted"})"),
        warnings);
    EXPECT_TRUE(warnings.empty());
    ASSERT_EQ(assignments.size(), 2U);
    EXPECT_EQ(assignments[0].pattern, "W*");
    EXPECT_EQ(assignments[0].material.absorption.at(125.0), 0.2);
    EXPECT_EQ(assignments[0].material.absorption.at(1000.0), 0.4);
    EXPECT_EQ(assignments[0].material.scattering.at(1000.0), 0.3);
    EXPECT_EQ(assignments[1].pattern, "A*");
    EXPECT_EQ(absorption(assignments[1].material),
              absorption(*propagation::find_library_material("brick-painted")));
}

TEST_F(MaterialFile, FaultsNameFileAndPattern) {
    const struct {
        const char* text;
        const char* told;
    } cases[] = {{"[]", "is not a JSON object"},
                 {"{\"a\": ", "is not JSON"},
                 {R"({"Wall": 0.2})", "pattern \"Wall\": is neither a library name"},
                 {R"({"Wall": {"absorption": 1.2}})", "pattern \"Wall\": absorption is 1.2"},
                 {R"({"Wall": "bricks-painted"})", "pattern \"Wall\": the library has no"}};
    for (const auto& [text, told] : cases) {
        const std::string line = error_of(text);
        EXPECT_NE(line.find("room.materials.json"), std::string::npos) << line;
        EXPECT_NE(line.find(told), std::string::npos) << line;
    }
}

TEST(MaterialAssignments, TheFileStandsBesideTheScene) {
    EXPECT_EQ(material_assignments_file("models/room.v2.obj"), "models/room.v2.materials.json");
}

}  // namespace
}  // namespace earshot::io
