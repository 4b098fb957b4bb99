// SPDX-License-Identifier: MIT

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace earshot::test {
namespace {

using Json = nlohmann::json;

/// A classroom of 7.2 x 9 m, 3.2 m high, as modellers with +Z up write it, in a unit.
struct Classroom {
    double metres_per_unit = 1.0;

    std::array<double, 3> in_unit(double x, double y, double z) const {
        return {x / metres_per_unit, y / metres_per_unit, z / metres_per_unit};
    }

    std::string point(double x, double y, double z) const {
        const auto p = in_unit(x, y, z);
        std::ostringstream text;
        text.precision(17);
        text << p[0] << ',' << p[1] << ',' << p[2];
        return text.str();
    }

    std::string obj() const {
        std::ostringstream text;
        text.precision(17);
        for (unsigned corner = 0; corner < 8; ++corner) {
            const auto p = in_unit((corner & 1U) != 0 ? 7.2 : 0.0,
                                   (corner & 2U) != 0 ? 9.0 : 0.0,
                                   (corner & 4U) != 0 ? 3.2 : 0.0);
            text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
        }
        text << "usemtl Carpet floor\nf 1 2 4 3\nusemtl Wall 1\nf 1 2 6 5\nf 3 4 8 7\n"
                "usemtl Wall 2\nf 1 3 7 5\nf 2 4 8 6\nusemtl Tiles\nf 5 6 8 7\n";
        return text.str();
    }
};

class ModelMeaning : public testing::Test {
protected:
    /// `earshot ir` of a room between two points given in its unit, order 3 and no rays.
    RunResult ir(const Classroom& room, const std::vector<std::string>& options) {
        const auto file = folder_.file("room.obj", room.obj());
        std::vector<std::string> arguments = {"ir",
                                              file.string(),
                                              "--source",
                                              "teacher=" + room.point(3.6, 1.0, 1.6),
                                              "--listener",
                                              "back=" + room.point(3.1, 8.5, 1.2),
                                              "-o",
                                              out().string(),
                                              "--order",
                                              "3"};
        if (std::find(options.begin(), options.end(), "--rays") == options.end()) {
            arguments.insert(arguments.end(), {"--rays", "0"});
        }
        arguments.insert(arguments.end(), options.begin(), options.end());
        return run_earshot(arguments);
    }

    std::filesystem::path out() const { return folder_.path() / "out"; }

    Json paths() const {
        std::ifstream file(out() / "paths.json");
        return Json::parse(file)["pairs"][0]["paths"];
    }

    const TemporaryFolder folder_;
};

TEST_F(ModelMeaning, ARoomInAnotherUnitIsWarnedOfWithTheCure) {
    const RunResult inches = ir({0.0254}, {});
    ASSERT_EQ(inches.status, 0) << inches.err;
    EXPECT_NE(inches.err.find("--units in --up z makes it 7.2 x 3.2 x 9 m"), std::string::npos)
        << inches.err;
    const RunResult millimetres = ir({0.001}, {});
    EXPECT_NE(millimetres.err.find("--units mm --up z makes it 7.2 x 3.2 x 9 m"), std::string::npos)
        << millimetres.err;
}

TEST_F(ModelMeaning, TheRightUnitGivesThePathsOfTheRoomInMetres) {
    ASSERT_EQ(ir({1.0}, {"--up", "z"}).status, 0);
    const Json metres = paths();
    ASSERT_EQ(metres.size(), 63U);  // the images of a box up to order 3
    for (const auto& [unit, size] :
         {std::pair{"in", 0.0254}, {"mm", 0.001}, {"cm", 0.01}, {"ft", 0.3048}}) {
        const RunResult result = ir({size}, {"--up", "z", "--units", unit});
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(result.err.find("not that of a room"), std::string::npos) << result.err;
        const Json found = paths();
        ASSERT_EQ(found.size(), metres.size()) << unit;
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i]["triangles"], metres[i]["triangles"]) << unit;
            EXPECT_NEAR(found[i]["length"].get<double>(), metres[i]["length"].get<double>(), 1e-6);
        }
    }
}

TEST_F(ModelMeaning, PointsAreInTheFilesUnitAndTheResultInMetres) {
    ASSERT_EQ(ir({0.001}, {"--up", "z", "--units", "mm"}).status, 0);
    const Json direct = paths()[0];
    // (x, y, z) of a file with +Z up is (x, z, -y).
    const std::array<double, 3> source = {3.6, 1.6, -1.0};
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(direct["points"][0][k].get<double>(), source[k], 1e-12);
    }
}

TEST_F(ModelMeaning, TheSummaryTellsSizeAndVolume) {
    const RunResult text = ir({1.0}, {"--up", "z"});
    EXPECT_NE(text.out.find("extent     7.2 x 3.2 x 9 m"), std::string::npos) << text.out;
    const RunResult json = ir({1.0}, {"--up", "z", "--rays", "4000", "--json", "--quiet"});
    ASSERT_EQ(json.status, 0) << json.err;
    const Json summary = Json::parse(json.out);
    EXPECT_NEAR(summary["height"].get<double>(), 3.2, 1e-12);
    // The box is convex: the source sees all of its air.
    EXPECT_NEAR(summary["volume"].get<double>(), 7.2 * 9.0 * 3.2, 0.05 * 7.2 * 9.0 * 3.2);
}

TEST_F(ModelMeaning, MaterialsAreAssignedByPatternAndFile) {
    const auto first_pressure = [&](const std::string& material) {
        for (const Json& path : paths()) {
            if (path["order"] == 1 && path["materials"][0] == material) {
                return path["pressure"][5].get<double>() * path["length"].get<double>();
            }
        }
        return 0.0;
    };
    const std::vector<std::string> plain = {"--up", "z", "--no-air-absorption"};
    ASSERT_EQ(ir({1.0}, plain).status, 0);
    // The default: absorption 0.1, and scattering 0.1 of what is reflected.
    EXPECT_NEAR(first_pressure("Carpet floor"), std::sqrt(0.9 * 0.9), 1e-12);

    std::ofstream(folder_.path() / "room.materials.json")
        << R"({"Carpet*": {"absorption": 0.36, "scattering": 0},
                "Wall ?": {"absorption": 0.75, "scattering": 0}})";
    RunResult result = ir({1.0}, plain);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NEAR(first_pressure("Carpet floor"), 0.8, 1e-12);
    EXPECT_NEAR(first_pressure("Wall 1"), 0.5, 1e-12);
    EXPECT_NE(result.err.find("material \"Tiles\" has no acoustic data"), std::string::npos)
        << result.err;

    // The command line counts after the file.
    std::vector<std::string> options = plain;
    options.insert(options.end(),
                   {"--material", "*=brick-painted", "--material", "Nothing=brick-painted"});
    result = ir({1.0}, options);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_GT(first_pressure("Wall 1"), 0.9);
    EXPECT_EQ(result.err.find("no acoustic data"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("no material of the scene matches \"Nothing\""), std::string::npos)
        << result.err;
}

TEST_F(ModelMeaning, GeometryCommandsDoNotSpeakOfMaterials) {
    const auto file = folder_.file("room.obj", Classroom{}.obj()).string();
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"bvh", file},
          {"los", file, "--from", "1,1,1", "--to", "2,2,2", "-o", (out().string() + ".csv")},
          {"visible", file, "--from", "1,1,1"}}) {
        const RunResult result = run_earshot(command);
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(result.err.find("acoustic"), std::string::npos) << result.err;
    }
}

TEST_F(ModelMeaning, ListenersComeFromATable) {
    const auto table = folder_.file("seats.csv", "name,x,y,z\nfront,3,3,1.2\nback row,3,8,1.2\n");
    const RunResult result = ir({1.0}, {"--up", "z", "--listeners", table.string()});
    ASSERT_EQ(result.status, 0) << result.err;
    for (const char* name : {"back", "front", "back row"}) {
        EXPECT_TRUE(std::filesystem::exists(out() / ("teacher__" + std::string(name) + ".wav")))
            << name;
    }
}

TEST_F(ModelMeaning, NamesThatWouldOverwriteAResultAreRefused) {
    for (const std::vector<std::string>& options :
         {std::vector<std::string>{"--source", "teacher=1,1,1"},
          {"--listener", "back=1,1,1"},
          {"--source", "teacher__back=1,1,1", "--listener", "back__back=2,2,1"},
          {"--source", "a/b=1,1,1", "--source", "a_b=2,1,1"}}) {
        const RunResult result = ir({1.0}, options);
        EXPECT_EQ(result.status, 1) << options[1];
        EXPECT_FALSE(std::filesystem::exists(out() / "paths.json"));
    }
}

TEST_F(ModelMeaning, AListenerOutsideOfTheRoomIsWarnedOf) {
    const RunResult result = ir({1.0}, {"--up", "z", "--listener", "yard=3,12,1"});
    EXPECT_NE(result.err.find("listener \"yard\" at 3, 1, -12 lies outside"), std::string::npos)
        << result.err;
}

TEST_F(ModelMeaning, WrongUnitsAndGltfAreRefused) {
    EXPECT_EQ(ir({1.0}, {"--units", "yd"}).status, 2);
    EXPECT_EQ(ir({1.0}, {"--up", "x"}).status, 2);
    const auto file = folder_.file("room.gltf", "{}").string();
    const RunResult result = run_earshot({"bvh", file, "--units", "mm"});
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find("in metres"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace earshot::test
