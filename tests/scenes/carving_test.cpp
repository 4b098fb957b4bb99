// SPDX-License-Identifier: MIT
#include "earshot/scenes/carving.h"

#include "earshot/geometry/clean.h"
#include "earshot/scenes/shapes.h"

#include "scenes/generated_mesh.h"
#include <cmath>

namespace earshot::scenes {
namespace {

// Single precision of coordinates below 16 m is 1e-6 m; a room of 100 m2 has volumes to 1e-4 m3.
constexpr double kVolumeTolerance = 1e-4;

std::size_t count_material(const Faces& faces, std::size_t material) {
    std::size_t count = 0;
    for (const Face& face : faces) {
        count += face.material == material ? 1U : 0U;
    }
    return count;
}

TEST(Carving, OneBoxHasSixFacesThatLookInside) {
    Carving room(0);
    room.carve({{0.0, 0.0, 0.0}, {8.0, 3.5, 6.0}});
    const Faces faces = room.surface();
    EXPECT_EQ(faces.size(), 6U);
    EXPECT_TRUE(is_closed(mesh_of(faces)));
    EXPECT_NEAR(signed_volume(mesh_of(faces)), -168.0, kVolumeTolerance);
}

TEST(Carving, BoxesThatTouchBecomeOneRoom) {
    Carving room(0);
    room.carve({{0.0, 0.0, 0.0}, {6.0, 3.0, 3.0}});
    room.carve({{0.0, 0.0, 3.0}, {3.0, 3.0, 6.0}});
    const geometry::Mesh mesh = mesh_of(room.surface());
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_EQ(mesh.positions.size(), 12U) << "the six corners of an L, twice";
    EXPECT_EQ(mesh.triangles.size(), 20U) << "2 V - 4 for a surface like a sphere's";
    EXPECT_NEAR(signed_volume(mesh), -81.0, kVolumeTolerance);
}

TEST(Carving, RockInTheMiddleIsASecondSurface) {
    Carving room(0);
    room.carve({{0.0, 0.0, 0.0}, {5.0, 5.0, 5.0}});
    room.fill({{2.0, 2.0, 2.0}, {3.0, 3.0, 3.0}});
    const geometry::Mesh mesh = mesh_of(room.surface());
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_EQ(mesh.triangles.size(), 24U);
    EXPECT_NEAR(signed_volume(mesh), -124.0, kVolumeTolerance);
}

TEST(Carving, HolesInFloorsAndSteppedWallsFitTogether) {
    Carving room(0);
    room.carve({{0.0, 0.0, 0.0}, {9.0, 4.0, 7.0}});
    room.fill({{2.0, 0.0, 2.0}, {3.0, 1.0, 3.0}});
    room.fill({{0.0, 0.0, 5.0}, {9.0, 0.5, 7.0}});
    room.fill({{0.0, 0.0, 6.0}, {9.0, 1.0, 7.0}});
    room.carve({{9.0, 0.0, 1.0}, {9.2, 2.0, 2.0}});
    const geometry::Mesh mesh = mesh_of(room.surface());
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_NEAR(signed_volume(mesh), -(252.0 - 1.0 - 9.0 - 4.5 + 0.4), kVolumeTolerance);
    EXPECT_EQ(geometry::clean(mesh.view()).report.t_junctions, 0U);
}

TEST(Carving, PaintCoversWhatLooksItsWay) {
    Carving room(0);
    const Box whole{{0.0, 0.0, 0.0}, {4.0, 3.0, 5.0}};
    room.carve(whole);
    room.paint(whole, 1, Facing::up);
    room.paint({{0.0, 1.0, 1.0}, {0.0, 2.0, 2.0}}, 2);
    const Faces faces = room.surface();
    EXPECT_TRUE(is_closed(mesh_of(faces)));
    EXPECT_EQ(count_material(faces, 1), 1U);
    ASSERT_EQ(count_material(faces, 2), 1U);
    for (const Face& face : faces) {
        for (std::size_t i = 0; i < face.corner_count; ++i) {
            if (face.material == 1) {
                EXPECT_EQ(face.corners[i].y, 0.0) << "the floor looks up";
            } else if (face.material == 2) {
                EXPECT_EQ(face.corners[i].x, 0.0);
            }
        }
    }
}

TEST(Carving, DivisionsCutFacesWithoutOpeningThem) {
    Carving room(0);
    room.carve({{0.0, 0.0, 0.0}, {4.0, 3.0, 5.0}});
    room.divide(2, 2.0);
    const Faces faces = room.surface();
    EXPECT_EQ(faces.size(), 10U);
    EXPECT_TRUE(is_closed(mesh_of(faces)));
}

TEST(Shapes, PrismsAreClosedAndLookOutwards) {
    EXPECT_TRUE(is_closed(mesh_of(box({-1.0, 0.0, 2.0}, {1.0, 3.0, 4.0}, 0))));
    EXPECT_NEAR(
        signed_volume(mesh_of(box({-1.0, 0.0, 2.0}, {1.0, 3.0, 4.0}, 0))), 12.0, kVolumeTolerance);
    const std::vector<Vec2> profile = {
        {0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}, {0.0, 2.0}};
    const double half = std::sqrt(0.5);
    const Frame frame{.origin = {3.0, 1.0, -2.0},
                      .u = {half, 0.0, -half},
                      .v = {0.0, 1.0, 0.0},
                      .w = {half, 0.0, half}};
    const geometry::Mesh mesh = mesh_of(prism(profile, 1.5, frame, 0));
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_EQ(mesh.triangles.size(), 20U);
    EXPECT_NEAR(signed_volume(mesh), 4.5, kVolumeTolerance);
}

}  // namespace
}  // namespace earshot::scenes
