// SPDX-License-Identifier: MIT
#include "earshot/propagation/plausibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Mesh;
using geometry::Vec3;

/// Appends a box without `left_out` (0 ... 11) of its twelve triangles; 12 leaves out none.
void add_box(Mesh& mesh, const Vec3& lower, const Vec3& upper, unsigned left_out = 12) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (unsigned corner = 0; corner < 8; ++corner) {
        mesh.positions.emplace_back((corner & 1U) != 0 ? upper.x : lower.x,
                                    (corner & 2U) != 0 ? upper.y : lower.y,
                                    (corner & 4U) != 0 ? upper.z : lower.z);
    }
    constexpr std::array<std::array<unsigned, 4>, 6> kSides{
        {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
    unsigned triangle = 0;
    for (const auto& side : kSides) {
        for (const unsigned k : {1U, 2U}) {
            if (triangle++ != left_out) {
                mesh.triangles.push_back({first + side[0], first + side[k], first + side[k + 1]});
            }
        }
    }
}

Scene scene_of(Mesh mesh) {
    Scene scene;
    scene.name = "room";
    scene.materials.push_back({.name = "wall"});
    scene.material_of_triangle.assign(mesh.triangles.size(), 0);
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

/// A room of 6 x 3 x 4 m with a closed cupboard of 1 x 2 x 0.5 m and an open shelf in it.
Scene furnished() {
    Mesh mesh;
    add_box(mesh, {0, 0, 0}, {6, 3, 4});
    add_box(mesh, {1, 0, 1}, {2, 2, 1.5});
    add_box(mesh, {3, 0, 1}, {4, 2, 1.5}, 3);
    return scene_of(std::move(mesh));
}

Warnings placed(Scene scene, const Vec3& source, const Vec3& listener) {
    scene.sources.push_back({.name = "s", .position = source});
    scene.listeners.push_back({.name = "l", .position = listener});
    return misplaced_emitters(scene, 0.0);
}

TEST(Plausibility, ARoomInMetresIsLeftAlone) {
    EXPECT_FALSE(propose_unit({7.2, 3.2, 9}, 0.0, {}));
    EXPECT_FALSE(propose_unit({50, 20, 80}, 60000.0, {}));
}

TEST(Plausibility, TheUnitThatMakesARoomIsProposed) {
    // The same classroom of 7.2 x 3.2 x 9 m in other units.
    for (const auto& [unit, metres] : {std::pair{"in", 0.0254}, {"mm", 0.001}, {"cm", 0.01}}) {
        const Vec3 size = Vec3(7.2, 3.2, 9) / metres;
        const auto proposal = propose_unit(size, 0.0, {});
        ASSERT_TRUE(proposal) << unit;
        EXPECT_EQ(proposal->best.unit, unit);
        EXPECT_NEAR(proposal->best.size.y, 3.2, 1e-12);
        EXPECT_NE(unit_warning(*proposal, size, true).find(std::string("--units ") + unit),
                  std::string::npos);
    }
}

TEST(Plausibility, TheUpAxisIsProposedWithTheUnit) {
    // As modellers write it: 7.2 x 9 m on the floor, 3.2 m along +Z.
    for (const auto& [unit, metres] : {std::pair{"in", 0.0254}, {"mm", 0.001}, {"cm", 0.01}}) {
        const Vec3 size = Vec3(7.2, 9, 3.2) / metres;
        const auto proposal = propose_unit(size, 0.0, {});
        ASSERT_TRUE(proposal) << unit;
        EXPECT_EQ(proposal->best.unit, unit);
        EXPECT_EQ(proposal->best.up, "z");
        EXPECT_NEAR(proposal->best.size.y, 3.2, 1e-12);
        const std::string cure = std::string("--units ") + unit + " --up z makes it";
        EXPECT_NE(unit_warning(*proposal, size, true).find(cure), std::string::npos);
    }
}

TEST(Plausibility, MetresAreProposedWhereAnotherUnitWasGiven) {
    const auto proposal = propose_unit(Vec3(7.2, 3.2, 9) * 0.001, 0.0, {.metres_per_unit = 0.001});
    ASSERT_TRUE(proposal);
    EXPECT_EQ(proposal->best.unit, "m");
}

TEST(Plausibility, WhatNoUnitMakesARoomIsToldWithoutAProposal) {
    const auto proposal = propose_unit({5000, 0.001, 5000}, 0.0, {});
    ASSERT_TRUE(proposal);
    EXPECT_TRUE(proposal->best.unit.empty());
}

TEST(Plausibility, TheUpAxisStaysWhereTheHeightIsTheSmallestSide) {
    // A hall of 20.2 x 16 x 42.1 m in cm. Standing on its end, in mm, it would be closer to 3 m.
    const auto proposal = propose_unit({2020, 1600, 4210}, 0.0, {});
    ASSERT_TRUE(proposal);
    EXPECT_EQ(proposal->best.unit, "cm");
    EXPECT_EQ(proposal->best.up, "");
    // Of a city read as a room nothing makes one.
    const auto city = propose_unit({240, 42, 240}, 0.0, {});
    ASSERT_TRUE(city);
    EXPECT_TRUE(city->best.unit.empty());
}

TEST(Plausibility, ReadingsThatAreAsProbableAreTold) {
    // 8 x 6.3 x 16 m in cm, or a hall of 20.3 x 16 x 40.6 m in inches.
    const Vec3 size(800, 630, 1600);
    auto proposal = propose_unit(size, 0.0, {});
    ASSERT_TRUE(proposal);
    EXPECT_EQ(proposal->best.unit, "cm");
    EXPECT_TRUE(proposal->others.empty());
    // Lower, so that both are closer: 4 m in cm, 10.2 m in inches; or 3.5 m and 8.9 m.
    proposal = propose_unit({800, 250, 1600}, 0.0, {});
    ASSERT_TRUE(proposal);
    EXPECT_EQ(proposal->best.unit, "cm");
    ASSERT_EQ(proposal->others.size(), 1U);
    EXPECT_EQ(proposal->others[0].unit, "in");
    EXPECT_NEAR(proposal->others[0].size.y, 6.35, 1e-12);
    EXPECT_NE(unit_warning(*proposal, size, true).find("--units in makes it 20.3 x 6.35 x 40.6 m"),
              std::string::npos);
}

TEST(Plausibility, PlacesOutdoorsAreJudgedByTheirOwnLimits) {
    Mesh mesh;
    add_box(mesh, {0, 0, 0}, {240, 42, 240});
    Scene scene = scene_of(mesh);
    EXPECT_EQ(model_kind(scene, 0.0), ModelKind::room);
    scene.materials.push_back({.name = "sky", .absorption = EnergyCoefficient(1.0)});
    // One of the twelve triangles, on a side of 240 x 42 m: under a tenth; then the largest ones.
    scene.material_of_triangle[0] = 1;
    EXPECT_EQ(model_kind(scene, 0.0), ModelKind::room);
    std::fill(scene.material_of_triangle.begin() + 6, scene.material_of_triangle.end(), 1);
    EXPECT_EQ(model_kind(scene, 0.0), ModelKind::outdoors);

    EXPECT_FALSE(propose_unit({240, 42, 240}, 2e6, {}, ModelKind::outdoors));
    EXPECT_FALSE(propose_unit({60, 0, 80}, 0.0, {}, ModelKind::outdoors));
    const auto proposal = propose_unit({240000, 42000, 240000}, 0.0, {}, ModelKind::outdoors);
    ASSERT_TRUE(proposal);
    EXPECT_EQ(proposal->best.unit, "mm");
    EXPECT_EQ(unit_reason(*proposal), "an extent of 240000 m is not that of a place outdoors");
}

TEST(Plausibility, AVolumeBeyondThatOfHallsIsTold) {
    const auto proposal = propose_unit({150, 39, 150}, 300000.0, {});
    ASSERT_TRUE(proposal);
    EXPECT_NE(proposal->problem.find("volume"), std::string::npos);
}

TEST(Plausibility, SourcesAndListenersInTheAirOfARoomAreLeftAlone) {
    EXPECT_TRUE(placed(furnished(), {5, 1, 2}, {0.5, 1.2, 3}).empty());
}

TEST(Plausibility, AListenerInASolidIsTold) {
    const Warnings warnings = placed(furnished(), {5, 1, 2}, {1.5, 1, 1.25});
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("listener \"l\""), std::string::npos) << warnings[0].what;
    EXPECT_NE(warnings[0].what.find("inside the closed surface"), std::string::npos);
}

TEST(Plausibility, ASourceInASolidIsTold) {
    const Warnings warnings = placed(furnished(), {1.5, 1, 1.25}, {5, 1, 2});
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("source \"s\""), std::string::npos) << warnings[0].what;
}

// On a surface a point counts from the side of the pair's other point.
TEST(Plausibility, PointsOnSurfacesAreLeftAlone) {
    for (const Vec3& on_surface : {Vec3(2, 0, 3),      // the floor
                                   Vec3(5.5, 3, 3.9),  // the ceiling
                                   Vec3(0, 0, 0),      // a corner
                                   Vec3(6, 1, 2.5),    // a wall
                                   Vec3(6 + 1e-7, 1, 2.5),
                                   Vec3(1.5, 2, 1.25)}) {  // the cupboard
        EXPECT_TRUE(placed(furnished(), on_surface, {5, 1, 2}).empty()) << on_surface.x;
        EXPECT_TRUE(placed(furnished(), {5, 1, 2}, on_surface).empty()) << on_surface.x;
    }
}

TEST(Plausibility, AnOpenShelfIsNoSolid) {
    EXPECT_TRUE(placed(furnished(), {5, 1, 2}, {3.5, 1, 1.25}).empty());
}

TEST(Plausibility, AListenerBeyondTheSceneIsToldOnce) {
    const Warnings warnings = placed(furnished(), {5, 1, 2}, {3.5, 1, 7});
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("outside of the scene"), std::string::npos);
}

TEST(Plausibility, AListenerOutsideOfTheRoomButWithinTheExtentIsTold) {
    Mesh mesh;
    add_box(mesh, {0, 0, 0}, {6, 3, 4});
    add_box(mesh, {20, 0, 0}, {21, 5, 4}, 0);  // something else that stands about, open
    const Warnings warnings = placed(scene_of(std::move(mesh)), {5, 1, 2}, {10, 1, 2});
    // The room has 0.3 of the scene's extent, so it is taken for a solid round the source.
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].what.find("closed surface"), std::string::npos) << warnings[0].what;
}

TEST(Plausibility, SidesDoNotDependOnOrientation) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        Mesh mesh;
        add_box(mesh, {0, 0, 0}, {6, 3, 4});
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            if ((seed * 2654435761U >> (t + 3)) % 2 == 1) {
                std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
            }
        }
        const Warnings warnings = placed(scene_of(std::move(mesh)), {1, 1, 1}, {3, 1.5, 4.5});
        EXPECT_EQ(warnings.size(), 1U);
    }
}

TEST(Plausibility, AHoleIsNoWall) {
    Mesh mesh;
    add_box(mesh, {0, 0, 0}, {6, 3, 4}, 5);
    add_box(mesh, {-10, -1, -10}, {-9, 9, 9}, 0);
    EXPECT_TRUE(placed(scene_of(std::move(mesh)), {1, 1, 1}, {-5, 1.5, 2}).empty());
}

}  // namespace
}  // namespace earshot::propagation
