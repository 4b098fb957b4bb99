// SPDX-License-Identifier: MIT

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Collide : public testing::Test {
protected:
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
    /// A floor and a triangle above it at `height`, one mesh.
    std::string pose(const std::string& name, double height) const {
        std::ofstream file(folder_.path() / name);
        file << "OFF\n6 2 0\n-4 0 -4\n-4 0 4\n4 0 0\n0 " << height << " 0\n1 " << height + 1
             << " 0\n0 " << height + 1 << " 1\n3 0 1 2\n3 3 4 5\n";
        return path(name);
    }

    const TemporaryFolder folder_;
};

TEST_F(Collide, PosesOfOneMeshAreSteps) {
    const RunResult result = run_earshot({"collide",
                                          pose("a.off", 2.0),
                                          pose("b.off", 1.0),
                                          pose("c.off", -0.5),
                                          "-o",
                                          path("contacts.json"),
                                          "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(read_file(folder_.path() / "contacts.json"));
    EXPECT_EQ(json["version"], 1);
    ASSERT_EQ(json["steps"].size(), 2U);
    EXPECT_TRUE(json["steps"][0]["contacts"].empty());
    const Json contacts = json["steps"][1]["contacts"];
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts[0]["kind"], "vertex_face");
    EXPECT_EQ(contacts[0]["a"], Json({{"mesh", 0}, {"element", {3}}}));
    EXPECT_EQ(contacts[0]["b"], Json({{"mesh", 0}, {"element", {0, 1, 2}}}));
    EXPECT_LE(contacts[0]["toi"].get<double>(), 2.0 / 3.0);
    EXPECT_NEAR(contacts[0]["toi"].get<double>(), 2.0 / 3.0, 1e-11);
    EXPECT_NEAR(contacts[0]["normal"][1].get<double>(), 1.0, 1e-12);
    EXPECT_EQ(Json::parse(result.out)["contacts"], 1);
}

TEST_F(Collide, TablesHoldTheSame) {
    ASSERT_EQ(run_earshot(
                  {"collide", pose("a.off", 1.0), pose("b.off", -0.5), "-o", path("contacts.csv")})
                  .status,
              0);
    const std::string text = read_file(folder_.path() / "contacts.csv");
    EXPECT_TRUE(text.starts_with("t0,t1,kind,")) << text;
    EXPECT_NE(text.find("0.0,1.0,vertex_face,0,3,0,0 1 2,0.66666"), std::string::npos) << text;
}

TEST_F(Collide, DiscreteContactsAreAtInstants) {
    ASSERT_EQ(run_earshot({"collide",
                           pose("a.off", 1.0),
                           pose("b.off", -0.5),
                           "--discrete",
                           "-o",
                           path("contacts.json")})
                  .status,
              0);
    const Json json = Json::parse(read_file(folder_.path() / "contacts.json"));
    ASSERT_EQ(json["steps"].size(), 2U);
    EXPECT_TRUE(json["steps"][0]["contacts"].empty());
    const Json& step = json["steps"][1];
    EXPECT_EQ(step["t0"], step["t1"]);
    ASSERT_EQ(step["contacts"].size(), 1U);
    EXPECT_EQ(step["contacts"][0]["kind"], "triangle_triangle");
    EXPECT_EQ(step["contacts"][0]["b"]["element"], Json({3, 4, 5}));
}

TEST_F(Collide, TellsItsWorkAndWhatItDidToTrees) {
    const std::string scene = test::source_file("scenes/curtain.gltf").string();
    for (const char* mode : {"--self", "--discrete"}) {
        std::vector<Json> summaries;
        for (const char* threads : {"1", "2"}) {
            const RunResult result = run_earshot({"collide",
                                                  scene,
                                                  mode,
                                                  "--self",
                                                  "--frames",
                                                  "0:0.8:0.2",
                                                  "--threads",
                                                  threads,
                                                  "-o",
                                                  path("contacts.json"),
                                                  "--json"});
            ASSERT_EQ(result.status, 0) << result.err;
            summaries.push_back(Json::parse(result.out));
            summaries.back().erase("seconds");
        }
        EXPECT_EQ(summaries[0], summaries[1]);
        const Json& summary = summaries[0];
        EXPECT_GT(summary["box_tests"], 0);
        EXPECT_GT(summary["triangle_pairs"], 0);
        EXPECT_GT(summary["elementary_tests"], 0);
        // Trees are built in the first step and follow in the others.
        EXPECT_GT(summary["front_nodes"], 0);
        const Json& hierarchy = summary["hierarchy"];
        EXPECT_GE(hierarchy["refits"].get<int>() + hierarchy["repairs"].get<int>() +
                      hierarchy["rebuilds"].get<int>(),
                  3);
    }
}

TEST_F(Collide, FirstIsTheFirstOfAll) {
    const std::string scene = test::source_file("scenes/door.gltf").string();
    const auto run = [&](const std::string& file, std::vector<std::string> more) {
        std::vector<std::string> arguments{
            "collide", scene, "--frames", "0:2:0.5", "-o", path(file), "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const RunResult result = run_earshot(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        return Json::parse(read_file(folder_.path() / file))["steps"];
    };
    for (const std::vector<std::string>& mode :
         {std::vector<std::string>{}, {"--rigid"}, {"--discrete"}}) {
        std::vector<std::string> with_first = mode;
        with_first.emplace_back("--first");
        const Json first = run("first.json", with_first);
        const Json all = run("all.json", mode);
        ASSERT_LE(first.size(), all.size());
        for (std::size_t i = 0; i < first.size(); ++i) {
            const Json& contacts = all[i]["contacts"];
            ASSERT_EQ(first[i]["contacts"].size(), contacts.empty() ? 0U : 1U);
            if (!contacts.empty()) {
                EXPECT_EQ(first[i]["contacts"][0], contacts[0]);
                EXPECT_EQ(i + 1, first.size());
            }
        }
    }
}

TEST_F(Collide, AnAnimationIsTheSameForAnyNumberOfThreads) {
    const std::string scene = test::source_file("scenes/curtain.gltf").string();
    std::vector<std::string> texts;
    for (const char* threads : {"1", "2", "8"}) {
        const RunResult result = run_earshot({"collide",
                                              scene,
                                              "--frames",
                                              "0:0.6:0.2",
                                              "--self",
                                              "--min-separation",
                                              "0.001",
                                              "--tolerance",
                                              "0.001",
                                              "-o",
                                              path("contacts.json"),
                                              "--threads",
                                              threads});
        ASSERT_EQ(result.status, 0) << result.err;
        texts.push_back(read_file(folder_.path() / "contacts.json"));
        EXPECT_EQ(Json::parse(texts.back())["steps"].size(), 3U);
    }
    EXPECT_EQ(texts[0], texts[1]);
    EXPECT_EQ(texts[0], texts[2]);
}

TEST_F(Collide, SaysInOneLineWhatIsWrongAndWritesNothing) {
    std::ofstream(path("other.off")) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::ofstream(path("nan.off")) << "OFF\n3 1 0\n0 nan 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::ofstream(path("empty.off")) << "OFF\n0 0 0\n";
    const std::string a = pose("a.off", 1.0), b = pose("b.off", -0.5), out = path("contacts.json");
    struct Case {
        int status;
        std::string says;
        std::vector<std::string> arguments;
    };
    const std::vector<Case> cases{
        {1, "other.off", {a, path("other.off"), "-o", out}},
        {1, "nan.off", {a, path("nan.off"), "-o", out}},
        {1, "empty.off", {path("empty.off"), "-o", out}},
        {1, "no.gltf", {path("no.gltf"), "-o", out}},
        {1, "none/contacts.json", {a, b, "-o", path("none/contacts.json")}},
        {1, "is a directory", {a, b, "-o", folder_.path().string()}},
        {2, "--output", {a}},
        {2, "FILES", {"-o", out}},
        {2, "--frames", {a, "-o", out, "--frames", "1"}},
        {2, "--frames", {a, b, "-o", out, "--frames", "0:1:0.1"}},
        {2, "--animation", {a, b, "-o", out, "--animation", "walk"}},
        {2, "--min-separation", {a, b, "-o", out, "--min-separation", "-1"}},
        {2, "--min-separation", {a, b, "-o", out, "--min-separation", "nan"}},
        {2, "--tolerance", {a, b, "-o", out, "--tolerance", "0"}},
    };
    const auto files = [&] {
        return std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator());
    };
    const auto before = files();
    for (const Case& each : cases) {
        std::vector<std::string> arguments{"collide"};
        arguments.insert(arguments.end(), each.arguments.begin(), each.arguments.end());
        const RunResult result = run_earshot(arguments);
        EXPECT_EQ(result.status, each.status) << each.says;
        EXPECT_TRUE(result.err.starts_with("earshot: error: ")) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_NE(result.err.find(each.says), std::string::npos) << result.err;
        EXPECT_EQ(result.out, "") << each.says;
        EXPECT_EQ(files(), before) << each.says;
    }
}

TEST_F(Collide, TakesTrianglesWithoutArea) {
    // A vertex that falls onto a segment, which is what the floor is.
    const auto write = [&](const char* name, double height) {
        std::ofstream(path(name)) << "OFF\n6 2 0\n-4 0 0\n4 0 0\n0 0 0\n0 " << height << " 0\n1 "
                                  << height + 1 << " 0\n0 " << height + 1
                                  << " 1\n3 0 1 2\n3 3 4 5\n";
        return path(name);
    };
    const RunResult result = run_earshot(
        {"collide", write("a.off", 1.0), write("b.off", -1.0), "-o", path("contacts.json")});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json contacts =
        Json::parse(read_file(folder_.path() / "contacts.json"))["steps"][0]["contacts"];
    ASSERT_FALSE(contacts.empty());
    EXPECT_EQ(contacts[0]["kind"], "vertex_face");
    EXPECT_LE(contacts[0]["toi"].get<double>(), 0.5);
    EXPECT_NEAR(contacts[0]["toi"].get<double>(), 0.5, 1e-11);
}

/// A file of tests/data/cases/geometry.
std::string case_file(const std::string& name) {
    return test::source_file("tests/data/cases/geometry/" + name).string();
}

/// Runs `collide` on a scene; the steps that it writes.
class CollideCases : public Collide {
protected:
    Json run(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "collide");
        arguments.insert(arguments.end(), {"-o", path("contacts.json")});
        const RunResult result = run_earshot(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        return result.status == 0 ? Json::parse(read_file(folder_.path() / "contacts.json"))
                                  : Json();
    }
    static std::size_t contacts_of(const Json& file) {
        std::size_t count = 0;
        for (const Json& step : file["steps"]) {
            count += step["contacts"].size();
        }
        return count;
    }
};

TEST_F(CollideCases, SplitVerticesOfAMeshAreOne) {
    const std::string folder = "01-split-vertices/";
    // A closed cube that only slides does not touch itself, however its file splits vertices.
    for (const char* file : {"cube_split.gltf", "cube_welded.gltf"}) {
        const std::string scene = case_file(folder + file);
        EXPECT_EQ(contacts_of(run({scene, "--self"})), 0U) << file;
        EXPECT_EQ(contacts_of(run({scene, "--self", "--discrete"})), 0U) << file;
    }
    const std::string two_materials = case_file(folder + "cube_two_materials.gltf");
    const Json file = run({two_materials});
    EXPECT_EQ(contacts_of(file), 0U);
    EXPECT_EQ(file["meshes"].size(), 1U);
    EXPECT_EQ(contacts_of(run({two_materials, "--self", "--discrete"})), 0U);
    const std::string stl = case_file(folder + "cube.stl");
    EXPECT_EQ(contacts_of(run({stl, "--self"})), 0U);
    EXPECT_EQ(contacts_of(run({stl, "--self", "--discrete"})), 0U);
    EXPECT_EQ(contacts_of(run({stl, stl})), 0U);
    // Without joining, neighbours touch.
    EXPECT_EQ(contacts_of(run({stl, "--self", "--no-weld"})), 378U);
    EXPECT_EQ(contacts_of(run({stl, "--self", "--discrete", "--no-weld"})), 48U);
    EXPECT_EQ(contacts_of(run({case_file(folder + "cube_split.gltf"), "--self", "--no-weld"})),
              6300U);
}

TEST_F(CollideCases, ObjectsOfAnObjAreMeshes) {
    const Json file = run({case_file("06-obj-objects/two_cubes_overlap.obj"), "--discrete"});
    EXPECT_EQ(file["meshes"], Json({"left", "right"}));
    ASSERT_EQ(file["steps"].size(), 1U);
    EXPECT_EQ(contacts_of(file), 18U);
    for (const Json& contact : file["steps"][0]["contacts"]) {
        EXPECT_EQ(contact["a"]["mesh"], 0);
        EXPECT_EQ(contact["b"]["mesh"], 1);
        EXPECT_LT(contact["b"]["element"][2], 8);  // vertices count within the mesh
    }
    // Vertices of different meshes are never one: these two share an edge's positions, and touch.
    EXPECT_EQ(contacts_of(run({case_file("06-obj-objects/two_objects.obj"), "--discrete"})), 1U);
}

TEST_F(CollideCases, ASceneThatDoesNotMoveHasOneInstant) {
    const std::string obj = case_file("07-static-discrete-doubled/fcl503.obj");
    const Json discrete = run({obj, "--discrete", "--self"});
    ASSERT_EQ(discrete["steps"].size(), 1U);
    EXPECT_EQ(discrete["steps"][0]["contacts"].size(), 62U);
    EXPECT_EQ(discrete["steps"][0]["t0"], 0.0);
    EXPECT_EQ(discrete["steps"][0]["t1"], 0.0);
    EXPECT_EQ(run({obj, "--discrete", "--self", "--frames", "0:0:1"}), discrete);
    EXPECT_EQ(run({obj, "--self"})["steps"].size(), 1U);
    EXPECT_EQ(run({obj, "--self", "--frames", "0:0:1"})["steps"].size(), 1U);
    EXPECT_EQ(run({pose("still.off", -0.5), "--self", "--discrete"})["steps"].size(), 1U);
    // A moving one keeps its instants.
    const std::string door = test::source_file("scenes/door.gltf").string();
    EXPECT_EQ(run({door, "--discrete", "--frames", "0:0.2:0.1"})["steps"].size(), 3U);
    EXPECT_EQ(run({door, "--frames", "0:0.2:0.1"})["steps"].size(), 2U);
}

TEST_F(CollideCases, CoordinatesTooSmallForExactTestsAreZero) {
    EXPECT_EQ(
        contacts_of(run({case_file("13-denormals/denormal_apart.obj"), "--discrete", "--self"})),
        0U);
    // A triangle above another at a height that counts as 0, one at a height that does not, and
    // one that lies lower by as little.
    const auto write = [&](const char* name, const char* height) {
        std::ofstream(path(name)) << "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0.2 " << height << " 0.2\nv 0.3 "
                                  << height << " 0.2\nv 0.2 1 0.3\nf 1 2 3\nf 4 5 6\n";
        return path(name);
    };
    EXPECT_EQ(contacts_of(run({write("a.obj", "4e-324"), "--discrete", "--self"})), 1U);
    EXPECT_EQ(contacts_of(run({write("b.obj", "1e-91"), "--discrete", "--self"})), 1U);
    EXPECT_EQ(contacts_of(run({write("c.obj", "1e-89"), "--discrete", "--self"})), 0U);
    EXPECT_EQ(contacts_of(run({write("d.obj", "-1e-200"), "--self"})), 2U);
}

TEST_F(CollideCases, DepthOfConvexPartsIsTheShortestSeparation) {
    const Json file =
        run({case_file("14-solid-depth/libccd25.obj"), "--discrete", "--self", "--distance"});
    ASSERT_EQ(file["steps"][0]["distances"].size(), 1U);
    const Json within = file["steps"][0]["distances"][0];
    EXPECT_NEAR(within["depth"].get<double>(), 0.1, 1e-15);
    EXPECT_NEAR(std::abs(within["move"][2].get<double>()), 0.1, 1e-15);
    EXPECT_EQ(within["parts"], Json({0, 1}));
    EXPECT_FALSE(within.contains("distance"));
    // The same cubes as objects, and a third one half a metre beside the first.
    std::ofstream obj(path("three.obj"));
    int first = 1;
    for (const auto& [name, x, z] :
         {std::tuple("low", 0.0, 0.0), {"high", 0.0, 1.9}, {"beside", 2.5, 0.0}}) {
        obj << "o " << name << "\n";
        for (int i = 0; i < 8; ++i) {
            obj << "v " << x + ((i & 1) != 0 ? 1 : -1) << " " << ((i & 2) != 0 ? 1 : -1) << " "
                << z + ((i & 4) != 0 ? 1 : -1) << "\n";
        }
        for (const auto& [a, b, c, d] : {std::tuple(0, 2, 3, 1),
                                         {4, 5, 7, 6},
                                         {0, 1, 5, 4},
                                         {2, 6, 7, 3},
                                         {0, 4, 6, 2},
                                         {1, 3, 7, 5}}) {
            obj << "f " << first + a << " " << first + b << " " << first + c << " " << first + d
                << "\n";
        }
        first += 8;
    }
    obj.close();
    const Json three = run({path("three.obj"), "--discrete", "--distance"});
    EXPECT_EQ(three["meshes"], Json({"low", "high", "beside"}));
    const Json& pairs = three["steps"][0]["distances"];
    ASSERT_EQ(pairs.size(), 3U);
    EXPECT_EQ(pairs[0]["distance"], 0.0);
    EXPECT_NEAR(pairs[0]["depth"].get<double>(), 0.1, 1e-15);
    EXPECT_FALSE(pairs[0].contains("points"));
    EXPECT_EQ(pairs[1]["a"], 0);
    EXPECT_EQ(pairs[1]["b"], 2);
    EXPECT_EQ(pairs[1]["distance"], 0.5);
    EXPECT_FALSE(pairs[1].contains("depth"));
    EXPECT_EQ(pairs[1]["points"][0][0], 1.0);
    EXPECT_EQ(pairs[1]["points"][1][0], 1.5);
    EXPECT_NEAR(pairs[2]["distance"].get<double>(), 0.5, 1e-15);
}

TEST_F(CollideCases, RigidNodesTurnOnScrews) {
    // A rod turns into a box: its side reaches the corner where asin(0.01 / r) is left.
    const double expected = 0.48750226;
    const std::string rotor = case_file("15-rotation/rotor.gltf");
    const Json whole = run({rotor, "--frames", "0:1:1", "--rigid"});
    ASSERT_EQ(whole["steps"].size(), 1U);
    ASSERT_FALSE(whole["steps"][0]["contacts"].empty());
    const double toi = whole["steps"][0]["contacts"][0]["toi"];
    EXPECT_NEAR(toi, expected, 1e-8);
    // The first contact of many steps, and the only one that is written.
    const Json first = run({rotor, "--rigid", "--first"});
    ASSERT_EQ(contacts_of(first), 1U);
    const Json& step = first["steps"].back();
    const double t0 = step["t0"], t1 = step["t1"];
    EXPECT_NEAR(t0 + step["contacts"][0]["toi"].get<double>() * (t1 - t0), expected, 1e-8);
    EXPECT_LT(t0, expected);
    EXPECT_GT(t1, expected);
    // Half a turn, whose two ends do not tell which way.
    const Json half = run({case_file("15-rotation/rotor180.gltf"), "--frames", "0:1:1", "--rigid"});
    ASSERT_FALSE(half["steps"][0]["contacts"].empty());
    const double angle = std::atan2(1.48, 0.02) - std::asin(0.01 / std::hypot(1.48, 0.02));
    EXPECT_NEAR(
        half["steps"][0]["contacts"][0]["toi"].get<double>(), angle / std::acos(-1.0), 1e-7);
}

TEST_F(CollideCases, AHintSaysWhereChordsAreFarFromTheMotion) {
    const std::string rotor = case_file("15-rotation/rotor.gltf");
    const auto warnings = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "collide");
        arguments.insert(arguments.end(), {"-o", path("contacts.json")});
        return run_earshot(arguments).err;
    };
    const std::string hint = "turns by 90 degrees in step 0";
    EXPECT_NE(warnings({rotor, "--frames", "0:1:1"}).find(hint), std::string::npos);
    EXPECT_NE(warnings({rotor, "--frames", "0:1:1"}).find("--rigid"), std::string::npos);
    EXPECT_EQ(warnings({rotor, "--frames", "0:1:1", "--rigid"}).find("turns by"),
              std::string::npos);
    EXPECT_EQ(warnings({rotor}).find("turns by"), std::string::npos);
    EXPECT_EQ(warnings({rotor, "--discrete", "--frames", "0:1:1"}).find("turns by"),
              std::string::npos);
}

TEST_F(CollideCases, ASummaryHasALineForEachPair) {
    const RunResult result = run_earshot({"collide",
                                          case_file("06-obj-objects/two_cubes_overlap.obj"),
                                          "--discrete",
                                          "--summary",
                                          "--distance",
                                          "--first",
                                          "-o",
                                          path("contacts.json")});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("pair       left - right: 1 contact, first at 0"), std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find("first      at 0: left face "), std::string::npos) << result.out;
    EXPECT_NE(result.out.find(", depth "), std::string::npos) << result.out;
    const RunResult json = run_earshot({"collide",
                                        case_file("15-rotation/rotor.gltf"),
                                        "--rigid",
                                        "--first",
                                        "--summary",
                                        "--json",
                                        "-o",
                                        path("contacts.json")});
    ASSERT_EQ(json.status, 0) << json.err;
    const Json summary = Json::parse(json.out);
    EXPECT_NEAR(summary["first"].get<double>(), 0.48750226, 1e-8);
    ASSERT_EQ(summary["pairs"].size(), 1U);
    EXPECT_EQ(summary["pairs"][0]["contacts"], 1);
    const RunResult none = run_earshot({"collide",
                                        case_file("01-split-vertices/cube.stl"),
                                        "--self",
                                        "--first",
                                        "-o",
                                        path("contacts.json")});
    EXPECT_NE(none.out.find("first      none"), std::string::npos) << none.out;
}

TEST_F(CollideCases, OptionsThatDoNotGoTogetherAreRefused) {
    const std::string rotor = case_file("15-rotation/rotor.gltf");
    const std::string a = pose("a.off", 1.0), b = pose("b.off", -0.5), out = path("contacts.json");
    EXPECT_TRUE(failed_with(
        run_earshot({"collide", rotor, "--rigid", "--discrete", "-o", out}), 2, "--rigid"));
    EXPECT_TRUE(failed_with(run_earshot({"collide", a, b, "--rigid", "-o", out}), 2, "--rigid"));
    EXPECT_TRUE(
        failed_with(run_earshot({"collide", rotor, "--distance", "-o", path("contacts.csv")}),
                    2,
                    "--distance"));
}

TEST_F(CollideCases, CoincidentTrianglesAreListedPairByPair) {
    std::ofstream obj(path("many.obj"));
    constexpr int kCount = 60;
    for (int i = 0; i < kCount; ++i) {
        obj << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
    }
    obj.close();
    const Json joined = run({path("many.obj"), "--self", "--discrete"});
    EXPECT_EQ(contacts_of(joined), kCount * (kCount - 1) / 2U);
    const Json& contact = joined["steps"][0]["contacts"][0];
    EXPECT_EQ(contact["point"], Json({0.5, 0.5, 0.0}));  // of the longest side's ends
    const Json apart = run({path("many.obj"), "--self", "--discrete", "--no-weld"});
    EXPECT_EQ(contacts_of(apart), kCount * (kCount - 1) / 2U);
    EXPECT_EQ(apart["steps"][0]["contacts"][0]["point"], contact["point"]);
}

}  // namespace
}  // namespace earshot::test
