// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/gltf_builder.h"
#include "support/temporary_folder.h"

namespace earshot::io {
namespace {

using Json = nlohmann::json;
using propagation::Material;

LoadedScene load_with(const Json& material) {
    test::GltfBuilder builder = test::one_triangle();
    builder.json["materials"] = Json::array({material});
    builder.primitive(0)["material"] = 0;
    const test::TemporaryFolder folder;
    return load_scene(folder.file("scene.glb", builder.glb()));
}

LoadedScene load_with_acoustics(const Json& acoustics) {
    return load_with({{"name", "wall"}, {"extras", {{"acoustics", acoustics}}}});
}

TEST(AcousticsExtras, ReadsCoefficientsPerBandAndPlain) {
    const LoadedScene loaded = load_with_acoustics({{"absorption", {{"125", 0.1}, {"4000", 0.7}}},
                                                    {"scattering", 0.25},
                                                    {"transmission", {{"1000", 0.01}}},
                                                    {"one_sided", true}});
    ASSERT_EQ(loaded.scene.materials.size(), 1U);
    const Material& wall = loaded.scene.materials[0];
    EXPECT_EQ(wall.name, "wall");
    ASSERT_EQ(wall.absorption.points().size(), 2U);
    EXPECT_EQ(wall.absorption.points()[0].frequency_hz, 125.0);
    EXPECT_EQ(wall.absorption.points()[1].value, 0.7);
    EXPECT_EQ(wall.scattering.at(500.0), 0.25);
    EXPECT_EQ(wall.transmission.at(1000.0), 0.01);
    EXPECT_TRUE(wall.one_sided);
    EXPECT_TRUE(warnings_of_acoustics(loaded).empty());
    EXPECT_EQ(loaded.scene.material_of_triangle, std::vector<std::uint32_t>{0});
}

// Real walls are not mirrors, unless the file says so.
TEST(AcousticsExtras, OnlyAnExplicitZeroScattersNothing) {
    const Material silent = load_with_acoustics({{"absorption", 0.3}}).scene.materials[0];
    EXPECT_EQ(silent.scattering.at(500.0), 0.1);
    const Material mirror =
        load_with_acoustics({{"absorption", 0.3}, {"scattering", 0}}).scene.materials[0];
    EXPECT_EQ(mirror.scattering.at(500.0), 0.0);
    const Material nameless = load_with({{"name", "wall"}}).scene.materials[0];
    EXPECT_EQ(nameless.scattering.at(500.0), 0.1);
    const Material row = load_with_acoustics("marble").scene.materials[0];
    EXPECT_EQ(row.scattering.at(500.0), 0.05);
    EXPECT_EQ(Material{}.scattering.at(500.0), 0.0);
}

TEST(AcousticsExtras, RefusesMoreTransmissionThanAbsorption) {
    try {
        load_with_acoustics({{"absorption", 0.1}, {"transmission", 0.5}});
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_NE(error.line().find("material \"wall\""), std::string::npos) << error.line();
        EXPECT_NE(error.line().find("transmission 0.5 exceeds absorption 0.1"), std::string::npos)
            << error.line();
    }
}

TEST(AcousticsExtras, CoefficientsNotGivenAreTheDefaults) {
    const Material wall = load_with_acoustics(Json::object()).scene.materials[0];
    EXPECT_EQ(wall.absorption.at(1000.0), 0.1);
    for (const double frequency_hz : {31.5, 1000.0, 16000.0}) {
        EXPECT_EQ(wall.scattering.at(frequency_hz), 0.1);
    }
    EXPECT_EQ(wall.transmission.at(1000.0), 0.0);
    EXPECT_FALSE(wall.one_sided);
}

TEST(AcousticsExtras, LibraryMaterialsByReferenceAndByName) {
    const auto brick = propagation::find_library_material("brick-painted");
    ASSERT_TRUE(brick.has_value());
    const LoadedScene referred = load_with_acoustics({{"library", "brick-painted"}});
    EXPECT_EQ(referred.scene.materials[0].name, "wall");
    EXPECT_EQ(referred.scene.materials[0].absorption.at(500.0), brick->absorption.at(500.0));
    EXPECT_TRUE(warnings_of_acoustics(referred).empty());
    const LoadedScene named = load_with({{"name", "brick-painted"}});
    EXPECT_EQ(named.scene.materials[0].absorption.at(500.0), brick->absorption.at(500.0));
    EXPECT_TRUE(warnings_of_acoustics(named).empty());
    const LoadedScene changed =
        load_with_acoustics({{"library", "brick-painted"}, {"scattering", 0.5}});
    EXPECT_EQ(changed.scene.materials[0].scattering.at(500.0), 0.5);
    EXPECT_EQ(changed.scene.materials[0].absorption.at(500.0), brick->absorption.at(500.0));
}

TEST(AcousticsExtras, OthersTakeTheDefaultAndOneWarningNamesEach) {
    const LoadedScene loaded = load_with({{"name", "lambert1"}, {"doubleSided", true}});
    EXPECT_EQ(loaded.scene.materials[0].absorption.at(500.0), 0.1);
    EXPECT_FALSE(loaded.scene.materials[0].one_sided);
    EXPECT_TRUE(loaded.warnings.empty());
    const Warnings warnings = warnings_of_acoustics(loaded);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("lambert1"), std::string::npos);
}

TEST(AcousticsExtras, UnusedMaterialsAreNotWarnedAbout) {
    test::GltfBuilder builder = test::one_triangle();
    builder.json["materials"] = {{{"name", "lambert1"}}, {{"name", "brick-painted"}}};
    builder.primitive(0)["material"] = 1;
    const test::TemporaryFolder folder;
    const LoadedScene loaded = load_scene(folder.file("scene.glb", builder.glb()));
    EXPECT_TRUE(warnings_of_acoustics(loaded).empty());
    EXPECT_EQ(loaded.scene.material_of_triangle, std::vector<std::uint32_t>{1});
}

TEST(AcousticsExtras, UnknownKeysAreWarnedAbout) {
    const LoadedScene loaded = load_with_acoustics({{"absorbtion", 0.5}});
    EXPECT_TRUE(loaded.warnings.empty());
    const Warnings warnings = warnings_of_acoustics(loaded);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("absorbtion"), std::string::npos);
}

/// The triangle's material, whose extras are these.
LoadedScene load_with_extras(const Json& extras) {
    return load_with({{"name", "wall"}, {"extras", extras}});
}

TEST(AcousticsExtras, MayBeALibraryNameOrJsonText) {
    const auto brick = propagation::find_library_material("brick-painted");
    const LoadedScene named = load_with_extras({{"acoustics", "brick-painted"}});
    EXPECT_EQ(named.scene.materials[0].absorption.at(500.0), brick->absorption.at(500.0));
    EXPECT_EQ(named.scene.materials[0].name, "wall");
    const LoadedScene text = load_with_extras(
        {{"acoustics", R"({"absorption": {"125": 0.2, "250": 0.4}, "scattering": 0.3})"}});
    EXPECT_EQ(text.scene.materials[0].absorption.at(250.0), 0.4);
    EXPECT_EQ(text.scene.materials[0].scattering.at(250.0), 0.3);
    EXPECT_TRUE(warnings_of_acoustics(named).empty());
    EXPECT_TRUE(warnings_of_acoustics(text).empty());
}

TEST(AcousticsExtras, FlatKeysAreThoseOfAPropertyPanel) {
    const auto brick = propagation::find_library_material("brick-painted");
    const LoadedScene loaded = load_with_extras({{"acoustics_library", "brick-painted"},
                                                 {"acoustics_scattering", 0.25},
                                                 {"acoustics_transmission", R"({"125": 0.01})"},
                                                 {"acoustics_one_sided", 1}});
    const Material& wall = loaded.scene.materials[0];
    EXPECT_EQ(wall.absorption.at(500.0), brick->absorption.at(500.0));
    EXPECT_EQ(wall.scattering.at(500.0), 0.25);
    EXPECT_EQ(wall.transmission.at(500.0), 0.01);
    EXPECT_TRUE(wall.one_sided);
    EXPECT_TRUE(warnings_of_acoustics(loaded).empty());
}

TEST(AcousticsExtras, NearMissesAreWarnedAbout) {
    for (const Json& extras : {Json{{"library", "brick-painted"}, {"absorption", 0.3}},
                               Json{{"acoustic", "brick-painted"}, {"Scattering", 0.3}},
                               Json{{"Acoustics", "brick-painted"}, {"acoustic_absorption", 1}}}) {
        const LoadedScene loaded = load_with_extras(extras);
        ASSERT_EQ(loaded.acoustic_warnings.size(), 2U) << extras;
        for (const auto& [key, value] : extras.items()) {
            const std::string told =
                loaded.acoustic_warnings[0].what + loaded.acoustic_warnings[1].what;
            EXPECT_NE(told.find("\"" + key + "\""), std::string::npos) << told;
        }
        EXPECT_EQ(loaded.default_materials.size(), 1U);
    }
}

TEST(AcousticsExtras, OtherPropertiesOfAModellerAreNoConcern) {
    const LoadedScene loaded =
        load_with_extras({{"colour", "red"}, {"price", 3}, {"acoustics", {{"absorption", 0.2}}}});
    EXPECT_TRUE(warnings_of_acoustics(loaded).empty());
}

TEST(AcousticsExtras, TextThatIsNeitherNameNorJsonIsRefused) {
    for (const char* text : {"{absorption: 0.1}", "[0.1]", "no such material", ""}) {
        EXPECT_THROW(load_with_extras({{"acoustics", text}}), Error) << text;
    }
}

TEST(AcousticsExtras, UnknownLibraryNameSuggestsNearOnes) {
    try {
        load_with_acoustics({{"library", "brick-paintd"}});
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_NE(error.line().find("\"wall\""), std::string::npos) << error.line();
        EXPECT_NE(error.line().find("nearest are brick-painted"), std::string::npos)
            << error.line();
    }
}

TEST(AcousticsExtras, RefusesWhatIsNoCoefficient) {
    const std::vector<Json> bad{
        {{"absorption", 1.2}},
        {{"absorption", -0.1}},
        {{"absorption", "0.1"}},
        {{"absorption", nullptr}},
        {{"absorption", Json::array({0.1})}},
        {{"absorption", Json::object()}},
        {{"absorption", {{"125", 1.2}}}},
        {{"absorption", {{"125", "much"}}}},
        {{"absorption", {{"low", 0.2}}}},
        {{"absorption", {{"-125", 0.2}}}},
        {{"absorption", {{"125", 0.2}, {"125.0", 0.3}}}},
        {{"scattering", 2}},
        {{"transmission", {{"0", 0.1}}}},
        {{"library", 3}},
        {{"one_sided", "yes"}},
        "absorbing",
    };
    for (const Json& acoustics : bad) {
        try {
            load_with_acoustics(acoustics);
            ADD_FAILURE() << "not refused: " << acoustics;
        } catch (const Error& error) {
            EXPECT_NE(error.line().find("material \"wall\""), std::string::npos) << error.line();
            EXPECT_FALSE(error.remedy().empty()) << error.line();
        }
    }
}

}  // namespace
}  // namespace earshot::io
