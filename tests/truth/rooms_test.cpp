// SPDX-License-Identifier: MIT
// A generator that makes other rooms than it says would turn every test over it into another one.
#include "support/rooms.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/air.h"
#include "support/random_rooms.h"
#include <algorithm>
#include <map>
#include <utility>

namespace earshot::support {
namespace {

using geometry::Vec3;

// Volume enclosed by the closed surfaces, by the divergence theorem: walls face the air, so the
// shell counts negative and obstacles positive; the sum is minus the volume of the air.
double air_volume(const Room& room) {
    double six_fold = 0.0;
    for (std::size_t i = 0; i < room.mesh.triangles.size(); ++i) {
        if (room.is_sheet[i] == 0) {
            const auto& t = room.mesh.triangles[i];
            const auto& p = room.mesh.positions;
            six_fold += glm::dot(p[t[0]], glm::cross(p[t[1]], p[t[2]]));
        }
    }
    return -six_fold / 6.0;
}

// Edges of closed surfaces that are not run along once in either direction as often.
std::size_t open_edges(const Room& room) {
    std::map<std::pair<geometry::VertexId, geometry::VertexId>, int> balance;
    for (std::size_t i = 0; i < room.mesh.triangles.size(); ++i) {
        for (std::size_t e = 0; e < 3 && room.is_sheet[i] == 0; ++e) {
            const auto a = room.mesh.triangles[i][e];
            const auto b = room.mesh.triangles[i][(e + 1) % 3];
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    return static_cast<std::size_t>(std::count_if(
        balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; }));
}

TEST(Rooms, ShellsAreClosedAndFaceTheAir) {
    EXPECT_NEAR(air_volume(box_room({-1.0, 0.0, 2.0}, {3.0, 2.5, 5.0})), 30.0, 1e-12);
    EXPECT_NEAR(air_volume(reference_box()), 8.0 * 6.0 * 3.5, 1e-12);
    EXPECT_NEAR(air_volume(reference_l_room()), 27.0 * 3.0, 1e-12);
    for (const Room& room : {box_room(Vec3{0.0}, Vec3{1.0}), reference_box(), reference_l_room()}) {
        EXPECT_EQ(open_edges(room), 0U);
    }
}

TEST(Rooms, TessellationKeepsTheBoxToTheLastBit) {
    const Vec3 lower{-0.1, 0.3, -2.7};
    const Vec3 upper{7.3, 2.9, 3.1};
    const Room room = tessellated_box_room(lower, upper, 16);
    EXPECT_EQ(room.mesh.triangles.size(), 3072U);
    EXPECT_EQ(open_edges(room), 0U);
    EXPECT_NEAR(air_volume(room), 7.4 * 2.6 * 5.8, 1e-10);
    for (std::size_t i = 0; i < room.mesh.triangles.size(); ++i) {
        const std::uint32_t label = room.labels[i];
        const int axis = static_cast<int>(label / 2);
        for (const geometry::VertexId v : room.mesh.triangles[i]) {
            EXPECT_EQ(room.mesh.positions[v][axis], label % 2 == 0 ? lower[axis] : upper[axis]);
        }
    }
    for (const Vec3& corner : box_corners(lower, upper)) {
        EXPECT_EQ(std::count(room.mesh.positions.begin(), room.mesh.positions.end(), corner), 1);
    }
}

TEST(Rooms, RandomRoomsAreClosedAndFollowFromTheSeed) {
    for (std::uint64_t seed = 0; seed < 10 * kRoomFamilies; ++seed) {
        const Room room = random_room(seed);
        EXPECT_EQ(open_edges(room), 0U) << "seed " << seed << ", " << room.kind;
        EXPECT_GT(air_volume(room), 1.0) << "seed " << seed << ", " << room.kind;
        EXPECT_GE(room.mesh.triangles.size(), 12U);
        EXPECT_LE(room.mesh.triangles.size(), 400U) << "seed " << seed << ", " << room.kind;
        EXPECT_EQ(room.mesh.positions, random_room(seed).mesh.positions);
        EXPECT_EQ(room.labels.size(), room.mesh.triangles.size());
    }
}

TEST(Air, IsInsideTheShellAndOutsideObstacles) {
    Room room = box_room(Vec3{0.0}, {5.0, 3.0, 4.0});
    add_hexahedron(room, box_corners({2.0, 0.0, 1.0}, {3.0, 1.0, 2.0}), Facing::outward, 6);
    EXPECT_TRUE(is_in_air(room, {1.0, 1.0, 1.0}));
    EXPECT_TRUE(is_in_air(room, {2.5, 1.5, 1.5}));
    EXPECT_FALSE(is_in_air(room, {2.5, 0.5, 1.5}));
    EXPECT_FALSE(is_in_air(room, {-1.0, 1.0, 1.0}));
    EXPECT_NEAR(distance_to_walls(room, {2.5, 1.25, 1.5}), 0.25, 1e-15);
}

}  // namespace
}  // namespace earshot::support
