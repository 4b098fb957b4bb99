// SPDX-License-Identifier: MIT
// Inputs that readers of meshes have failed on, as users of other programs reported them; the files
// are in tests/data/cases/geometry. Numbers of triangles and boxes were worked out by hand.
#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <fstream>
#include <sstream>

namespace earshot::test {
namespace {

std::string case_file(const std::string& name) {
    return source_file("tests/data/cases/geometry/" + name).string();
}

RunResult read_case(const std::string& name) {
    return run_earshot({"bvh", case_file(name), "--json"});
}

/// The lines that are not about acoustic data.
std::string without_acoustics(const std::string& text) {
    std::istringstream stream(text);
    std::string kept;
    for (std::string line; std::getline(stream, line);) {
        kept += line.find("acoustic data") == std::string::npos ? line + "\n" : "";
    }
    return kept;
}

struct Case {
    const char* file;
    int triangles;
    const char* warning = "";  ///< must be part of standard error; empty: nothing is there
};

TEST(GeometryCases, AreReadWhole) {
    const std::vector<Case> cases = {
        // tinyobjloader pull request 394: a UTF-8 mark glued to the first `v`.
        {"02-obj-bom/bom.obj", 2},
        {"02-obj-bom/bom_silent.obj", 2},
        // VCGLIB writes more values per row than the header names.
        {"03-ascii-ply-columns/extra_col_cube.ply", 12, "more values than the header names"},
        {"03-ascii-ply-columns/ascii_extra_tokens_vertex.ply", 2, "the first is line 10"},
        {"03-ascii-ply-columns/ascii_extra_tokens_face.ply", 2, "of the element \"face\""},
        // fstl 33, numpy-stl 88 and 206, meshlab 194.
        {"04-stl-solid-without-name/ascii_noname.stl", 2},
        {"04-stl-solid-without-name/ascii_bom.stl", 2},
        {"04-stl-solid-without-name/end_loop.stl", 2},
        {"04-stl-solid-without-name/end_solid.stl", 1},
        {"08-instancing-optional/instancing.gltf", 6},
        // ModelNet40 writes the counts onto the keyword (trimesh pull request 753).
        {"09-off-glued/glued.off", 2},
        // Organised scans mark missing points by NaN.
        {"10-nan-unused/nan_unused.ply", 2},
        {"11-gltf-refused/data_upper.gltf", 2},
        {"11-gltf-refused/idx7.gltf", 2, "7 indices are not whole triangles; the last 1"},
        {"11-gltf-refused/indices_noview.gltf", 2},
        {"11-gltf-refused/intfloat.gltf", 2},
        {"12-ply-face-first/vertex_after_face.ply", 2},
        {"16-messages/cr_only.obj", 2},
        {"16-messages/ascii_cr.ply", 2},
        {"16-messages/contin_space_after.obj", 2},
        {"16-messages/face_before_v.obj", 2},
        {"16-messages/fo.obj", 2},
        {"16-messages/ascii_oneline.stl", 2},
    };
    for (const Case& c : cases) {
        const RunResult result = read_case(c.file);
        ASSERT_EQ(result.status, 0) << c.file << ": " << result.err;
        EXPECT_EQ(nlohmann::json::parse(result.out).at("triangles"), c.triangles) << c.file;
        const std::string warnings = without_acoustics(result.err);
        if (*c.warning == '\0') {
            EXPECT_EQ(warnings, "") << c.file;
        }
        EXPECT_NE(warnings.find(c.warning), std::string::npos) << c.file << ": " << result.err;
    }
}

TEST(GeometryCases, AreRefusedWithTheReason) {
    const std::vector<std::pair<const char*, const char*>> cases = {
        {"05-path-escape/scene/up.gltf", "../up.bin lies outside of the scene's folder"},
        {"05-path-escape/scene/up_enc.gltf", "../up.bin lies outside of the scene's folder"},
        {"05-path-escape/scene/abs.gltf", "/etc/hostname lies outside of the scene's folder"},
        {"09-off-glued/headerless.off", "does not begin with OFF: line 1 holds numbers"},
        {"09-off-glued/oneline_body.off", "line 1: more than the numbers of vertices, faces"},
        {"11-gltf-refused/draco_not_required_noview.gltf", "its Draco data is not a mesh"},
        {"16-messages/utf16.obj", "is UTF-16 text; save it as UTF-8"},
        {"16-messages/ascii_noend.stl", "does not end with endsolid, line 15 is the last"},
        {"16-messages/ascii_quad.stl", "line 7: a facet needs three vertices, this is the fourth"},
    };
    for (const auto& [file, reason] : cases) {
        EXPECT_TRUE(failed_with(read_case(file), 1, reason)) << file;
    }
}

TEST(GeometryCases, AScenesOwnFolderMayBeLeftIfThatIsAllowed) {
    for (const char* name : {"up.gltf", "up_enc.gltf"}) {
        const RunResult result = run_earshot(
            {"bvh", case_file("05-path-escape/scene/") + name, "--allow-outside", "--json"});
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_EQ(nlohmann::json::parse(result.out).at("triangles"), 2);
    }
}

/// Runs `earshot collide` on a case; the summary, and the file as `contacts`.
nlohmann::json collide(const std::string& name, std::vector<std::string> options) {
    const TemporaryFolder folder;
    const std::string output = (folder.path() / "contacts.json").string();
    options.insert(options.begin(), {"collide", case_file(name), "--json", "-o", output});
    const RunResult result = run_earshot(options);
    EXPECT_EQ(result.status, 0) << name << ": " << result.err;
    nlohmann::json summary = nlohmann::json::parse(result.out, nullptr, false);
    std::ifstream stream(output);
    summary["file"] = nlohmann::json::parse(stream, nullptr, false);
    return summary;
}

TEST(GeometryCases, VerticesSplitForNormalsAndMaterialsAreOne) {
    // glTF-Blender-IO 1069: a closed cube that slides touches itself nowhere.
    EXPECT_EQ(collide("01-split-vertices/cube_welded.gltf", {"--self"}).at("contacts"), 0);
    EXPECT_EQ(collide("01-split-vertices/cube_split.gltf", {"--self"}).at("contacts"), 0);
    EXPECT_EQ(collide("01-split-vertices/cube_split.gltf", {"--self", "--discrete"}).at("contacts"),
              0);
    EXPECT_EQ(collide("01-split-vertices/cube_two_materials.gltf", {}).at("contacts"), 0);
    EXPECT_EQ(collide("01-split-vertices/cube.stl", {"--self", "--discrete"}).at("contacts"), 0);
}

TEST(GeometryCases, ObjectsOfAnObjAreMeshes) {
    const nlohmann::json cubes = collide("06-obj-objects/two_cubes_overlap.obj", {"--discrete"});
    EXPECT_EQ(cubes.at("contacts"), 18);
    EXPECT_EQ(cubes.at("file").at("meshes"), (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(collide("06-obj-objects/two_objects.obj", {"--discrete"}).at("meshes"), 2);
}

TEST(GeometryCases, ASceneThatRestsHasOneInstant) {
    // fcl 503.
    const nlohmann::json summary =
        collide("07-static-discrete-doubled/fcl503.obj", {"--discrete", "--self"});
    EXPECT_EQ(summary.at("steps"), 1);
    EXPECT_EQ(summary.at("contacts"), 62);
}

TEST(GeometryCases, TheDepthOfSolidsIsTheMoveThatPartsThem) {
    // libccd 25: cubes of 2 m, one 1.9 m above the other.
    const nlohmann::json file =
        collide("14-solid-depth/libccd25.obj", {"--self", "--discrete", "--distance"}).at("file");
    const nlohmann::json& distances = file.at("steps").at(0).at("distances");
    ASSERT_EQ(distances.size(), 1U);
    EXPECT_NEAR(distances.at(0).at("depth").get<double>(), 0.1, 1e-12);
}

TEST(GeometryCases, APartThatTurnsFarInAStepIsFoundOnScrews) {
    // python-fcl 38: the rod turns 90 degrees in the step and touches at t = 0.48750226.
    const nlohmann::json file =
        collide("15-rotation/rotor.gltf", {"--frames", "0:1:1", "--rigid"}).at("file");
    const nlohmann::json& contacts = file.at("steps").at(0).at("contacts");
    ASSERT_FALSE(contacts.empty());
    EXPECT_NEAR(contacts.at(0).at("toi").get<double>(), 0.48750226, 1e-6);
    EXPECT_LE(contacts.at(0).at("toi").get<double>(), 0.48750227);
}

TEST(GeometryCases, CoordinatesBelowTheRangeOfExactTestsAreZero) {
    // Two triangles in the plane z = 0 but for +-5e-324, 0.0485 m apart.
    EXPECT_EQ(collide("13-denormals/denormal_apart.obj", {"--discrete", "--self"}).at("contacts"),
              0);
}

}  // namespace
}  // namespace earshot::test
