// SPDX-License-Identifier: MIT
#include "earshot/propagation/long_decay.h"

#include "earshot/audio/room_metrics.h"

#include <gtest/gtest.h>

#include "one_material_scene.h"
#include <array>
#include <string>
#include <tuple>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

struct Wall {
    const char* name;
    double absorption;
    double scattering;
};

/// A box whose sides y = 0, y = top, z = 0, z = far, x = 0, x = far are of a material each.
OneMaterialScene box_of(const Vec3& size, const std::array<Wall, 6>& walls) {
    OneMaterialScene scene(box_mesh(size), 0.1, 0.0);
    scene.materials.clear();
    for (std::uint32_t side = 0; side < 6; ++side) {
        Material& material = scene.materials.emplace_back();
        material.name = walls[side].name;
        material.absorption = EnergyCoefficient(walls[side].absorption);
        material.scattering = EnergyCoefficient(walls[side].scattering);
        scene.material_of_triangle[2 * side] = side;
        scene.material_of_triangle[2 * side + 1] = side;
    }
    return scene;
}

const Vec3 kSource(2, 1.2, 1.5);

/// The cause of a decay `ratio` times as long as Eyring's.
std::string cause_at(const OneMaterialScene& scene,
                     double ratio,
                     Executor& executor = Executor::serial()) {
    const std::array sources = {kSource};
    const auto room = room_statistics(scene.scene(), sources);
    EXPECT_TRUE(room.has_value());
    const double t30 = ratio * audio::mid_frequency_mean(audio::Bands::octaves(), room->eyring);
    return long_decay_cause(scene.scene(), kSource, t30, *room, {}, executor);
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

constexpr std::array<Wall, 6> kFlutter = {{{"floor", 0.6, 0.1},
                                           {"ceiling", 0.6, 0.1},
                                           {"front", 0.6, 0.1},
                                           {"back", 0.6, 0.1},
                                           {"Wall_left", 0.05, 0.0},
                                           {"Wall_right", 0.05, 0.0}}};

TEST(LongDecay, TheNoteTellsHowMuchTooLongADecayIs) {
    EXPECT_EQ(long_decay_note(8.8, 0.44, "walls"),
              "T30 of 8.8 s is 20 times Eyring's 0.44 s: walls");
    EXPECT_EQ(long_decay_note(8.8, 0.44, ""), "T30 of 8.8 s is 20 times Eyring's 0.44 s");
}

TEST(LongDecay, TellsTheWallsOfAFlutterEcho) {
    const std::string note = cause_at(box_of({8, 3.5, 6}, kFlutter), 6.0);
    EXPECT_TRUE(contains(note, "\"Wall_left\" (no scattering)")) << note;
    EXPECT_TRUE(contains(note, "\"Wall_right\" (no scattering)")) << note;
    EXPECT_TRUE(contains(note, "to and fro between")) << note;
    for (const char* other : {"floor", "ceiling", "front", "back"}) {
        EXPECT_FALSE(contains(note, other)) << note;
    }
}

// A classroom's ceiling absorbs what meets it; the rest stays level.
TEST(LongDecay, TellsAllWallsWhereSoundStaysInAPlane) {
    const std::string note = cause_at(box_of({8, 3.5, 6},
                                             {{{"carpet", 0.3, 0.1},
                                               {"tiles", 0.9, 0.1},
                                               {"plaster", 0.03, 0.05},
                                               {"plaster", 0.03, 0.05},
                                               {"concrete", 0.03, 0.05},
                                               {"concrete", 0.03, 0.05}}}),
                                      3.0);
    EXPECT_TRUE(contains(note, "\"plaster\" (scattering 0.05)")) << note;
    EXPECT_TRUE(contains(note, "\"concrete\" (scattering 0.05)")) << note;
    EXPECT_FALSE(contains(note, "tiles") || contains(note, "carpet")) << note;
}

// A box in a box: the source is in a hard room with a window of 0.5 x 0.5 m into a dead one.
TEST(LongDecay, TellsWhereSoundStaysInCoupledRooms) {
    geometry::Mesh mesh;
    std::vector<std::uint32_t> materials;
    const auto add_quad = [&](std::uint32_t material, const std::array<Vec3, 4>& corners) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
        materials.insert(materials.end(), 2, material);
    };
    constexpr std::uint32_t kLive = 0, kDead = 1;
    for (const auto& [material, low, high] : {std::tuple{kLive, 0.0, 5.0}, {kDead, 5.0, 12.0}}) {
        add_quad(material, {{{low, 0, 0}, {high, 0, 0}, {high, 0, 3}, {low, 0, 3}}});
        add_quad(material, {{{low, 3, 0}, {high, 3, 0}, {high, 3, 3}, {low, 3, 3}}});
        add_quad(material, {{{low, 0, 0}, {high, 0, 0}, {high, 3, 0}, {low, 3, 0}}});
        add_quad(material, {{{low, 0, 3}, {high, 0, 3}, {high, 3, 3}, {low, 3, 3}}});
    }
    add_quad(kLive, {{{0, 0, 0}, {0, 3, 0}, {0, 3, 3}, {0, 0, 3}}});
    add_quad(kDead, {{{12, 0, 0}, {12, 3, 0}, {12, 3, 3}, {12, 0, 3}}});
    for (const auto& [low, high, bottom, top] : {std::tuple{0.0, 1.2, 0.0, 3.0},
                                                 {1.7, 3.0, 0.0, 3.0},
                                                 {1.2, 1.7, 0.0, 1.2},
                                                 {1.2, 1.7, 1.7, 3.0}}) {
        add_quad(kLive, {{{5, bottom, low}, {5, top, low}, {5, top, high}, {5, bottom, high}}});
    }
    OneMaterialScene scene(std::move(mesh), 0.02, 0.4);
    scene.material_of_triangle = materials;
    scene.materials[kLive].name = "concrete";
    scene.materials.push_back({.name = "carpet",
                               .absorption = EnergyCoefficient(0.8),
                               .scattering = EnergyCoefficient(0.4)});
    const std::string note = cause_at(scene, 4.0);
    EXPECT_TRUE(contains(note, "coupled rooms")) << note;
    EXPECT_TRUE(contains(note, "\"concrete\" (scattering 0.4)")) << note;
    EXPECT_FALSE(contains(note, "carpet")) << note;
    double x = 0.0, y = 0.0, z = 0.0;
    const std::string place = note.substr(note.find("about (") + 7);
    ASSERT_EQ(std::sscanf(place.c_str(), "%lf, %lf, %lf", &x, &y, &z), 3) << note;
    EXPECT_NEAR(x, 2.5, 0.3);
    EXPECT_NEAR(y, 1.5, 0.2);
    EXPECT_NEAR(z, 1.5, 0.2);
}

TEST(LongDecay, SurfacesOfOneMaterialFaceEachOther) {
    std::array<Wall, 6> walls = kFlutter;
    walls[5].name = walls[4].name = "stone";
    OneMaterialScene scene = box_of({8, 3.5, 6}, walls);
    scene.material_of_triangle[10] = scene.material_of_triangle[11] = 4;
    const std::string note = cause_at(scene, 6.0);
    EXPECT_TRUE(contains(note, "surfaces of \"stone\" (no scattering) that face each other"))
        << note;
}

TEST(LongDecay, ThreadsDoNotMatter) {
    const OneMaterialScene scene = box_of({8, 3.5, 6}, kFlutter);
    Executor executor(8);
    EXPECT_EQ(cause_at(scene, 2.0, executor), cause_at(scene, 2.0));
}

}  // namespace
}  // namespace earshot::propagation
