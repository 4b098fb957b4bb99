// SPDX-License-Identifier: MIT
#include "earshot/scenes/gltf_writer.h"
#include "earshot/scenes/models.h"
#include "earshot/scenes/picture.h"

#include <gtest/gtest.h>

#include "support/test_paths.h"
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

namespace earshot::scenes {
namespace {

const std::filesystem::path kFolder = test::source_file("scenes");

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    EXPECT_TRUE(stream.good()) << file;
    return {std::istreambuf_iterator<char>(stream), {}};
}

// Compared as a flag: a difference would print both files.
TEST(CommittedScenes, AreWhatTheGeneratorWrites) {
    for (const SceneDraft& draft : make_all()) {
        const bool same =
            write_gltf(draft, GltfForm::text).bytes == bytes_of(kFolder / (draft.name + ".gltf"));
        EXPECT_TRUE(same) << draft.name << ": run earshot_scenes all -o scenes";
    }
}

TEST(CommittedScenes, PicturesAreWhatTheGeneratorDraws) {
    for (const SceneDraft& draft : make_all()) {
        const std::string picture = draw_picture(draft);
        const bool same = picture == bytes_of(kFolder / "pictures" / (draft.name + ".svg"));
        EXPECT_TRUE(same) << draft.name << ": run earshot_scenes all -o scenes";
        EXPECT_LT(picture.size(), 60000U) << draft.name;
    }
}

TEST(CommittedScenes, AreSmallAndAllGenerated) {
    std::set<std::string> expected;
    for (const SceneDraft& draft : make_all()) {
        expected.insert(draft.name + ".gltf");
    }
    std::set<std::string> found;
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") {
            found.insert(entry.path().filename().string());
            bytes += entry.file_size();
        }
    }
    EXPECT_EQ(found, expected);
    EXPECT_LT(bytes, 3000000U);
}

}  // namespace
}  // namespace earshot::scenes
