// SPDX-License-Identifier: MIT
#include "earshot/io/file_frame.h"

#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <fstream>

namespace earshot::io {
namespace {

using geometry::Vec3;

TEST(FileFrame, UnitsAreThoseOfTheirDefinitions) {
    EXPECT_EQ(metres_per_unit("m"), 1.0);
    EXPECT_EQ(metres_per_unit("cm"), 0.01);
    EXPECT_EQ(metres_per_unit("mm"), 0.001);
    EXPECT_EQ(metres_per_unit("in"), 0.0254);
    EXPECT_DOUBLE_EQ(*metres_per_unit("ft"), 12 * 0.0254);
    EXPECT_FALSE(metres_per_unit("yd"));
}

TEST(FileFrame, ZUpIsTurnedAboutTheXAxis) {
    const FileFrame frame{.metres_per_unit = 1.0, .up = UpAxis::z};
    EXPECT_EQ(frame.to_scene({1, 2, 3}), Vec3(1, 3, -2));
    // A turn keeps handedness: the image of z is the cross product of those of x and y.
    EXPECT_EQ(glm::cross(frame.to_scene({1, 0, 0}), frame.to_scene({0, 1, 0})),
              frame.to_scene({0, 0, 1}));
    EXPECT_EQ(frame.to_file(frame.to_scene({1, 2, 3})), Vec3(1, 2, 3));
}

TEST(FileFrame, TheDefaultChangesNoBit) {
    const Vec3 point(0.1, -1e300, 5e-324);
    EXPECT_EQ(FileFrame{}.to_scene(point), point);
}

TEST(FileFrame, MeshFilesAreReadInTheirUnitAndAxes) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "room.obj";
    std::ofstream(file) << "v 0 0 100\nv 100 0 100\nv 0 50 100\nf 1 2 3\n";
    const auto loaded = load_scene(file, {.frame = {.metres_per_unit = 0.0254, .up = UpAxis::z}});
    const auto positions = loaded.scene.mesh.positions_at(0.0);
    EXPECT_EQ(positions[0], Vec3(0, 2.54, 0));
    EXPECT_EQ(positions[1], Vec3(2.54, 2.54, 0));
    EXPECT_EQ(positions[2], Vec3(0, 2.54, -1.27));
}

TEST(FileFrame, GltfIsInMetresWithYUp) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "room.gltf";
    std::ofstream(file) << "{}";
    try {
        load_scene(file, {.frame = {.metres_per_unit = 0.001, .up = UpAxis::y}});
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(error.line().find("in metres with +Y up"), std::string::npos) << error.line();
    }
}

}  // namespace
}  // namespace earshot::io
