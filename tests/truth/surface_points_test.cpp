// SPDX-License-Identifier: MIT
// Sources and listeners on surfaces against the closed form of the box (Allen and Berkley 1979),
// whose images need no surface: in the limit, an image and its mirror image coincide.
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/path_facts.h"
#include "support/rooms.h"
#include "support/shoebox_images.h"
#include "support/traced_room.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::support {
namespace {

using frustum::PlacementProblem;
using geometry::Vec3;

const Vec3 kLower = {0.0, 0.0, 0.0};
const Vec3 kUpper = {8.0, 3.5, 6.0};

// Points are moved by 2^-27 of the largest coordinate and twice that, and an image by twice as much
// for each reflection.
constexpr double kRelativeTolerance = 1e-6;

void expect_images(const TracedRoom& traced,
                   const Room& room,
                   const Vec3& source,
                   const Vec3& listener,
                   int max_order) {
    const auto placed = traced.place(source, std::vector<Vec3>{listener});
    ASSERT_FALSE(placed.undecided);
    const auto paths = traced.trace_placed(placed, {.max_order = max_order}).paths;
    EXPECT_EQ(disagreement(facts_of(paths, room.labels),
                           shoebox_images(kLower, kUpper, source, listener, max_order),
                           kRelativeTolerance),
              "")
        << "source " << source.x << ", " << source.y << ", " << source.z << ", listener "
        << listener.x << ", " << listener.y << ", " << listener.z;
}

TEST(SurfacePoints, OnTheWallsOfABoxAllImagesArrive) {
    const Room room = box_room(kLower, kUpper);
    const TracedRoom traced(room);
    const Vec3 inside = {5.5, 1.6, 4.0};
    for (const double height : {0.0, 1e-12, 1e-9, 1e-6}) {
        for (const Vec3& on_surface : {Vec3(2.0, height, 1.5),
                                       Vec3(2.0, 3.5 - height, 1.5),
                                       Vec3(8.0 - height, 1.1, 1.5),
                                       Vec3(2.0, 1.7, height)}) {
            expect_images(traced, room, on_surface, inside, 3);
            expect_images(traced, room, inside, on_surface, 3);
        }
    }
}

TEST(SurfacePoints, InEdgesAndCornersOfABoxAllImagesArrive) {
    const Room room = box_room(kLower, kUpper);
    const TracedRoom traced(room);
    const Vec3 inside = {5.5, 1.6, 4.0};
    for (const double height : {0.0, 1e-12, 1e-9, 1e-6}) {
        for (const Vec3& on_surface : {Vec3(height, height, 1.5),
                                       Vec3(3.0, 3.5 - height, 6.0 - height),
                                       Vec3(height, height, height),
                                       Vec3(8.0, 3.5, height)}) {
            expect_images(traced, room, on_surface, inside, 3);
            expect_images(traced, room, inside, on_surface, 3);
        }
    }
}

TEST(SurfacePoints, BothPointsMayLieOnDifferentSurfaces) {
    const Room room = box_room(kLower, kUpper);
    const TracedRoom traced(room);
    expect_images(traced, room, {2.0, 0.0, 1.5}, {5.0, 3.5, 4.0}, 3);
    expect_images(traced, room, {2.0, 0.0, 1.5}, {0.0, 1.0, 0.0}, 3);
    expect_images(traced, room, {0.0, 0.0, 0.0}, {8.0, 3.5, 6.0}, 3);
}

// Where the floor is cut into triangles of which the edges and corners lie under the point.
TEST(SurfacePoints, OnTheEdgesOfATessellationAllImagesArrive) {
    const Room room = tessellated_box_room(kLower, kUpper, 4);
    const TracedRoom traced(room);
    for (const Vec3& on_floor :
         {Vec3(2.0, 0.0, 1.5), Vec3(2.0, 0.0, 2.1), Vec3(3.0, 0.0, 2.25), Vec3(0.0, 0.0, 3.0)}) {
        expect_images(traced, room, on_floor, {5.5, 1.6, 4.0}, 2);
        expect_images(traced, room, {5.5, 1.6, 4.0}, on_floor, 2);
    }
}

// A room whose vertices are rounded to single precision after a turn: its walls are not quite flat.
TEST(SurfacePoints, OnARoundedTurnedFloorNoPathIsLost) {
    const Room room = box_room(kLower, kUpper);
    Room turned = room;
    const auto turn = [](const Vec3& p) {
        const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(0.4), t = std::sin(0.4);
        const Vec3 q = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
        return Vec3(q.x, d * q.y - t * q.z, t * q.y + d * q.z) + Vec3(11.3, -4.1, 7.7);
    };
    const auto rounded = [](const Vec3& p) {
        return Vec3(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
    };
    for (Vec3& p : turned.mesh.positions) {
        p = rounded(turn(p));
    }
    const TracedRoom traced(turned);
    const Vec3 listener = {5.5, 1.6, 4.0};
    for (const Vec3& source : {Vec3(2.0, 0.0, 1.5), Vec3(0.0, 0.0, 0.0), Vec3(8.0, 1.0, 3.0)}) {
        const auto placed = traced.place(rounded(turn(source)), std::vector<Vec3>{turn(listener)});
        ASSERT_FALSE(placed.undecided);
        const auto paths = traced.trace_placed(placed, {.max_order = 2}).paths;
        // Only lengths and walls: the image of a path is turned with the room.
        std::vector<double> found, expected;
        for (const auto& path : paths) {
            found.push_back(path.length);
        }
        for (const auto& image : shoebox_images(kLower, kUpper, source, listener, 2)) {
            expected.push_back(image.length);
        }
        std::sort(expected.begin(), expected.end());
        ASSERT_EQ(found.size(), expected.size()) << source.x << ", " << source.y;
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i], expected[i], 1e-4);  // a float of 20 m is off by 1e-6
        }
    }
}

/// A square sheet in the plane y = 0, in two triangles, seen from above.
Room sheet() {
    Room room;
    const std::vector<Vec3> ring = {
        {-2.0, 0.0, -2.0}, {-2.0, 0.0, 2.0}, {2.0, 0.0, 2.0}, {2.0, 0.0, -2.0}};
    add_polygon(room, ring, 7, true);
    return room;
}

TEST(SurfacePoints, EveryListenerHasItsOwnSideOfASheet) {
    const TracedRoom traced(sheet());
    const Vec3 source = {0.3, 0.0, 0.4};
    const std::vector<Vec3> listeners = {{1.0, 1.0, 1.0}, {1.0, -1.0, 1.0}, {0.0, 3.0, 0.0}};
    const auto placed = traced.place(source, listeners);
    ASSERT_FALSE(placed.undecided);
    ASSERT_EQ(placed.groups.size(), 2U);
    EXPECT_EQ(placed.groups[0].numbers, (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(placed.groups[1].numbers, (std::vector<std::size_t>{1}));
    const auto paths = traced.trace_placed(placed, {.max_order = 2}).paths;
    ASSERT_EQ(paths.size(), 6U);  // direct and reflected, at the same instant
    for (std::size_t i = 0; i < paths.size(); ++i) {
        EXPECT_EQ(paths[i].listener, i / 2);
        EXPECT_NEAR(paths[i].length, glm::distance(source, listeners[i / 2]), 1e-6);
    }
}

TEST(SurfacePoints, APlaneThatHoldsBothPointsDecidesNothing) {
    const TracedRoom traced(box_room(kLower, kUpper));
    const std::vector<Vec3> listeners = {{5.5, 1.6, 4.0}, {5.5, 0.0, 4.0}};
    const auto placed = traced.place({2.0, 0.0, 1.5}, listeners);
    ASSERT_TRUE(placed.undecided);
    EXPECT_TRUE(placed.undecided->is_source);
    EXPECT_EQ(placed.undecided->listener, 1U);
    EXPECT_EQ(placed.undecided->problem, PlacementProblem::other_point_in_plane);
    const Room room = box_room(kLower, kUpper);
    EXPECT_EQ(room.labels[traced.numbers()[placed.undecided->triangle]], 2U);  // the floor
    // A point clear of the plane needs no other to tell its side.
    const auto above = traced.place({2.0, 0.001, 1.5}, std::vector<Vec3>{{5.5, 0.0, 4.0}});
    EXPECT_FALSE(above.undecided);
}

TEST(SurfacePoints, TheEdgeOfAFreeSheetDecidesNothing) {
    const TracedRoom traced(sheet());
    const std::vector<Vec3> listener = {{1.0, 1.0, 1.0}};
    for (const Vec3& edge : {Vec3(2.0, 0.0, 0.5), Vec3(-2.0, 0.0, -2.0), Vec3(0.1, 1e-9, 2.0)}) {
        const auto placed = traced.place(edge, listener);
        ASSERT_TRUE(placed.undecided);
        EXPECT_TRUE(placed.undecided->is_source);
        EXPECT_EQ(placed.undecided->problem, PlacementProblem::edge_of_free_sheet);
        const auto reversed = traced.place(listener[0], std::vector<Vec3>{edge});
        ASSERT_TRUE(reversed.undecided);
        EXPECT_FALSE(reversed.undecided->is_source);
    }
    // Not at the diagonal, where the sheet goes on, nor beside the sheet.
    EXPECT_FALSE(traced.place({0.5, 0.0, 0.5}, listener).undecided);
    EXPECT_FALSE(traced.place({2.1, 0.0, 0.5}, listener).undecided);
}

TEST(SurfacePoints, PointsInTheAirStayWhereTheyAre) {
    const TracedRoom traced(box_room(kLower, kUpper));
    const std::vector<Vec3> listeners = {{5.5, 1.6, 4.0}, {1e-5, 1.0, 1.0}};
    const auto placed = traced.place({2.0, 1.2, 1.5}, listeners);
    EXPECT_FALSE(placed.is_moved);
    ASSERT_EQ(placed.groups.size(), 1U);
    EXPECT_EQ(placed.groups[0].positions, listeners);
}

// A float may put a point behind the wall that it is meant to lie on.
TEST(SurfacePoints, APointRoundedBehindItsWallBelongsToTheRoom) {
    const Room room = box_room(kLower, kUpper);
    const TracedRoom traced(room);
    const Vec3 listener = {5.5, 1.6, 4.0};
    const auto placed = traced.place({2.0, -1e-6, 1.5}, std::vector<Vec3>{listener});
    ASSERT_FALSE(placed.undecided);
    EXPECT_EQ(traced.trace_placed(placed, {.max_order = 2}).paths.size(), 25U);
}

}  // namespace
}  // namespace earshot::support
