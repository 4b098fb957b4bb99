// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/gltf_builder.h"
#include "support/temporary_folder.h"

namespace earshot::io {
namespace {

namespace fs = std::filesystem;
using test::GltfBuilder;
using Json = nlohmann::json;

/// A folder `scene` for scenes, with a buffer in it, and a folder `outside` beside it, with
/// another.
class SceneFolders : public testing::Test {
protected:
    SceneFolders() {
        fs::create_directories(scene() / "sub");
        fs::create_directories(root() / "outside");
        for (const char* place : {"scene/in.bin", "scene/sub/in.bin", "outside/out.bin"}) {
            folder_.file(place, builder_.bytes);
        }
    }

    fs::path root() const { return folder_.path(); }
    fs::path scene() const { return root() / "scene"; }

    /// The error line of a scene whose buffer has that URI; "read" if there is none.
    std::string outcome_of(const std::string& uri, bool allow_outside = false) const {
        return outcome_of_scene(folder_.file("scene/scene.gltf", builder_.gltf(uri)),
                                allow_outside);
    }

    static std::string outcome_of_scene(const fs::path& file, bool allow_outside = false) {
        try {
            const LoadedScene loaded = load_scene(file, {.allow_outside = allow_outside});
            return loaded.scene.mesh.triangles().size() == 1 ? "read" : "other triangles";
        } catch (const Error& error) {
            return error.line();
        }
    }

    void expect_refused(const std::string& uri) const {
        const std::string line = outcome_of(uri);
        EXPECT_NE(line.find("lies outside of the scene's folder"), std::string::npos)
            << uri << ": " << line;
        EXPECT_NE(line.find("--allow-outside"), std::string::npos) << line;
    }

    test::TemporaryFolder folder_;
    GltfBuilder builder_ = test::one_triangle();
};

TEST_F(SceneFolders, FilesInTheFolderAndBelowItAreRead) {
    for (const char* uri : {"in.bin", "./in.bin", "sub/in.bin", "sub/../in.bin", "sub%2Fin.bin"}) {
        EXPECT_EQ(outcome_of(uri), "read") << uri;
    }
}

TEST_F(SceneFolders, ParentFoldersAreRefused) {
    expect_refused("../outside/out.bin");
    expect_refused("./../outside/out.bin");
    expect_refused("sub/../../outside/out.bin");
    expect_refused("..//outside/out.bin");
    EXPECT_EQ(outcome_of("../outside/out.bin", true), "read");
    EXPECT_EQ(outcome_of("sub/../../outside/out.bin", true), "read");
}

TEST_F(SceneFolders, EscapedParentFoldersAreRefused) {
    expect_refused("%2e%2e/outside/out.bin");
    expect_refused("%2E%2e%2Foutside%2Fout.bin");
    expect_refused(".%2e/outside/out.bin");
    expect_refused("..\\outside\\out.bin");
    EXPECT_EQ(outcome_of("%2e%2e/outside/out.bin", true), "read");
}

TEST_F(SceneFolders, AbsolutePathsAreRefusedEvenIntoTheFolder) {
    expect_refused((root() / "outside/out.bin").string());
    expect_refused((scene() / "in.bin").string());
    expect_refused("/proc/self/environ");
    EXPECT_EQ(outcome_of((root() / "outside/out.bin").string(), true), "read");
}

TEST_F(SceneFolders, LinksThatLeaveAreRefused) {
    fs::create_symlink(root() / "outside/out.bin", scene() / "link.bin");
    fs::create_directory_symlink(root() / "outside", scene() / "link");
    fs::create_symlink(scene() / "link.bin", scene() / "chain.bin");
    expect_refused("link.bin");
    expect_refused("link/out.bin");
    expect_refused("chain.bin");
    EXPECT_EQ(outcome_of("link.bin", true), "read");
    fs::create_symlink(scene() / "sub/in.bin", scene() / "inside.bin");
    EXPECT_EQ(outcome_of("inside.bin"), "read");
}

TEST_F(SceneFolders, WhetherAFileOutsideExistsIsNotTold) {
    const std::string absent = outcome_of("../outside/absent.bin");
    EXPECT_NE(absent.find("lies outside"), std::string::npos) << absent;
}

TEST_F(SceneFolders, TheFolderIsThatOfTheScenesRealPath) {
    outcome_of("in.bin");  // writes scene/scene.gltf
    fs::create_symlink(scene() / "scene.gltf", root() / "outside/linked.gltf");
    EXPECT_EQ(outcome_of_scene(root() / "outside/linked.gltf"), "read");
    outcome_of("out.bin");
    EXPECT_NE(outcome_of_scene(root() / "outside/linked.gltf").find("out.bin is missing"),
              std::string::npos);
}

TEST_F(SceneFolders, OtherSchemesAndOddNamesAreNoFiles) {
    for (const char* uri : {"file:///etc/hostname", "http://example.org/a.bin", "FILE:in.bin"}) {
        EXPECT_NE(outcome_of(uri).find("is not a file"), std::string::npos) << uri;
        EXPECT_NE(outcome_of(uri, true).find("is not a file"), std::string::npos) << uri;
    }
    EXPECT_NE(outcome_of("in.bin%00.png").find("zero byte"), std::string::npos);
    EXPECT_NE(outcome_of("sub").find("sub is missing"), std::string::npos);
}

TEST_F(SceneFolders, ExportersDifferInWhatTheyEscape) {
    folder_.file("scene/y%20z.bin", builder_.bytes);
    folder_.file("scene/a b.bin", builder_.bytes);
    folder_.file("scene/50%.bin", builder_.bytes);
    for (const char* uri : {"y%20z.bin", "a%20b.bin", "a b.bin", "50%.bin", "sub\\in.bin"}) {
        EXPECT_EQ(outcome_of(uri), "read") << uri;
    }
}

TEST_F(SceneFolders, ImagesMayNotLieOutsideEither) {
    const auto outcome = [&](const std::string& uri, bool allow_outside) {
        builder_.json["images"] = {{{"uri", uri}}};
        return outcome_of("in.bin", allow_outside);
    };
    EXPECT_EQ(outcome("absent.png", false), "read");
    EXPECT_EQ(outcome("data:image/png;base64,AAAA", false), "read");
    EXPECT_NE(outcome("../outside/out.bin", false).find("image 0: its file ../outside/out.bin"),
              std::string::npos);
    EXPECT_NE(outcome("%2e%2e/x.png", false).find("lies outside"), std::string::npos);
    EXPECT_EQ(outcome("../outside/out.bin", true), "read");
}

TEST_F(SceneFolders, DirectivitiesMayNotLieOutsideEither) {
    const std::string table = "azimuth,elevation,1000\n0,0,0\n180,0,-6\n";
    folder_.file("outside/voice.csv", table);
    folder_.file("scene/voice.csv", table);
    const auto outcome = [&](const std::string& name) {
        builder_.json["nodes"][0]["extras"] = {
            {"acoustics", {{"role", "source"}, {"directivity", name}}}};
        return outcome_of("in.bin");
    };
    EXPECT_EQ(outcome("voice.csv"), "read");
    EXPECT_NE(outcome("../outside/voice.csv").find("lies outside"), std::string::npos);
    EXPECT_NE(outcome("absent.csv").find("absent.csv is missing"), std::string::npos);
}

TEST_F(SceneFolders, BuffersThatNothingUsesAreNotLookedFor) {
    builder_.json["buffers"] = Json::array();
    const fs::path file = scene() / "scene.gltf";
    Json json = Json::parse(builder_.gltf("in.bin"));
    json["buffers"].push_back({{"byteLength", 4}});
    json["buffers"].push_back({{"byteLength", 4}, {"uri", "absent.bin"}});
    json["bufferViews"].push_back({{"buffer", 2}, {"byteLength", 4}});
    folder_.file("scene/scene.gltf", json.dump());
    EXPECT_EQ(outcome_of_scene(file), "read");
}

TEST_F(SceneFolders, DataUrisAreNeverPrinted) {
    for (const char* uri : {"DATA:;base64,!!secret!!", "data:text/plain,!!secret!!"}) {
        const std::string line = outcome_of(uri);
        EXPECT_NE(line.find("base64"), std::string::npos) << line;
        EXPECT_EQ(line.find("secret"), std::string::npos) << line;
    }
    EXPECT_EQ(
        outcome_of("DATA:application/octet-stream;BASE64," + GltfBuilder::base64(builder_.bytes)),
        "read");
}

}  // namespace
}  // namespace earshot::io
