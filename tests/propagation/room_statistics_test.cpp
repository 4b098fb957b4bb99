// SPDX-License-Identifier: MIT
#include "earshot/propagation/room_statistics.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "one_material_scene.h"
#include <array>
#include <bit>
#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Mesh;
using geometry::Vec3;

constexpr std::size_t kBand = 5;  // 1 kHz

RoomStatistics statistics(const OneMaterialScene& scene,
                          std::span<const Vec3> sources,
                          bool air_absorption = false,
                          Executor& executor = Executor::serial()) {
    const auto found =
        room_statistics(scene.scene(), sources, {.air_absorption = air_absorption}, executor);
    EXPECT_TRUE(found.has_value());
    return found.value_or(RoomStatistics{});
}

/// Appends a box.
void append_box(Mesh& mesh, const Vec3& lower, const Vec3& size) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    const Mesh box = box_mesh(size);
    for (const Vec3& position : box.positions) {
        mesh.positions.push_back(lower + position);
    }
    for (const auto& [a, b, c] : box.triangles) {
        mesh.triangles.push_back({first + a, first + b, first + c});
    }
}

/// Every triangle into `divisions` squared.
Mesh tessellated(const Mesh& coarse, int divisions) {
    Mesh fine;
    for (std::size_t i = 0; i < coarse.triangles.size(); ++i) {
        const auto [a, b, c] = geometry::corners(coarse, i);
        const auto at = [&, a = a, b = b, c = c](int u, int v) {
            return a + (b - a) * (double(u) / divisions) + (c - a) * (double(v) / divisions);
        };
        const auto add = [&](const std::array<Vec3, 3>& corners) {
            const auto first = static_cast<geometry::VertexId>(fine.positions.size());
            fine.positions.insert(fine.positions.end(), corners.begin(), corners.end());
            fine.triangles.push_back({first, first + 1, first + 2});
        };
        for (int u = 0; u < divisions; ++u) {
            for (int v = 0; u + v < divisions; ++v) {
                add({at(u, v), at(u + 1, v), at(u, v + 1)});
                if (u + v + 1 < divisions) {
                    add({at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)});
                }
            }
        }
    }
    return fine;
}

TEST(RoomStatistics, ABoxHasItsVolumeAndSurface) {
    constexpr std::array<Vec3, 3> kSizes = {{{8, 3.5, 6}, {20, 2.5, 20}, {2, 30, 3}}};
    for (const Vec3& size : kSizes) {
        const OneMaterialScene scene(box_mesh(size), 0.2, 0.0);
        const std::array sources = {0.3 * size};
        const RoomStatistics room = statistics(scene, sources);
        EXPECT_NEAR(room.volume / (size.x * size.y * size.z), 1.0, 0.01);
        const double surface = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        EXPECT_NEAR(room.surface / surface, 1.0, 1e-9);
        EXPECT_EQ(room.opening, 0.0);
        EXPECT_NEAR(room.absorption[kBand], 0.2, 1e-12);
    }
}

// Sabine 0.161 V / A and Eyring, with the constants as ISO 3382-2 and textbooks have them.
TEST(RoomStatistics, TheTimesAreThoseOfSabineAndEyring) {
    const Vec3 size(8, 3.5, 6);
    const OneMaterialScene scene(box_mesh(size), 0.2, 0.0);
    const std::array sources = {Vec3(2, 1.2, 1.5)};
    const RoomStatistics room = statistics(scene, sources);
    const double volume = 168.0, surface = 194.0;
    EXPECT_NEAR(room.sabine[kBand], 0.161 * volume / (surface * 0.2), 0.01 * room.sabine[kBand]);
    EXPECT_NEAR(
        room.eyring[kBand], 0.161 * volume / (-surface * std::log(0.8)), 0.01 * room.eyring[kBand]);
    // Air of 20 degrees C and 50 % takes 4.7 dB per km at 1 kHz and 105 dB at 8 kHz (ISO 9613-1,
    // table 1).
    const RoomStatistics in_air = statistics(scene, sources, true);
    for (const auto& [band, decibels_per_km] :
         {std::pair<std::size_t, double>{5, 4.66}, {8, 105.0}}) {
        const double by_air = 4.0 * volume * decibels_per_km / 4343.0;
        EXPECT_NEAR(in_air.sabine[band],
                    0.161 * volume / (surface * 0.2 + by_air),
                    0.02 * in_air.sabine[band]);
    }
}

TEST(RoomStatistics, AFineMeshHasTheSameSurfaceAsACoarseOne) {
    // 120,000 triangles, twice as many as there are departures.
    const OneMaterialScene scene(tessellated(box_mesh({8, 3.5, 6}), 100), 0.2, 0.0);
    const std::array sources = {Vec3(2, 1.2, 1.5)};
    const RoomStatistics room = statistics(scene, sources);
    EXPECT_NEAR(room.surface, 194.0, 0.03 * 194.0);
    EXPECT_NEAR(room.volume, 168.0, 0.03 * 168.0);
}

TEST(RoomStatistics, FurnitureCountsWithItsOutsideAndLacksItsVolume) {
    Mesh mesh = box_mesh({6, 3, 4});
    append_box(mesh, {1, 0.5, 1}, {1, 2, 0.5});
    const OneMaterialScene scene(std::move(mesh), 0.2, 0.0);
    const std::array sources = {Vec3(4, 1.2, 1.5)};
    const RoomStatistics room = statistics(scene, sources);
    EXPECT_NEAR(room.volume, 71.0, 0.01 * 71.0);
    EXPECT_NEAR(room.surface, 108.0 + 7.0, 1e-6);
}

TEST(RoomStatistics, ARoomThatNoSourceIsInDoesNotCount) {
    Mesh mesh = box_mesh({6, 3, 4});
    append_box(mesh, {7, 0, 0}, {10, 4, 10});
    const OneMaterialScene scene(std::move(mesh), 0.2, 0.0);
    const std::array first = {Vec3(4, 1.2, 1.5)};
    EXPECT_NEAR(statistics(scene, first).volume, 72.0, 0.72);
    const std::array both = {Vec3(4, 1.2, 1.5), Vec3(9, 1, 1)};
    const RoomStatistics room = statistics(scene, both);
    EXPECT_NEAR(room.volume, 472.0, 4.72);
    EXPECT_NEAR(room.surface, 108.0 + 360.0, 1e-6);
}

// Two cubes with an opening of 0.8 x 0.8 m between them: sound spreads slowly, and the answer does
// not depend on where it starts.
TEST(RoomStatistics, BothOfTwoCoupledRoomsCountWhole) {
    Mesh mesh;
    const auto add_quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    };
    for (const auto& [low, high] : {std::pair{0.0, 3.0}, {3.0, 8.0}}) {
        add_quad({low, 0, 0}, {high, 0, 0}, {high, 0, 3}, {low, 0, 3});
        add_quad({low, 3, 0}, {high, 3, 0}, {high, 3, 3}, {low, 3, 3});
        add_quad({low, 0, 0}, {high, 0, 0}, {high, 3, 0}, {low, 3, 0});
        add_quad({low, 0, 3}, {high, 0, 3}, {high, 3, 3}, {low, 3, 3});
    }
    for (const double x : {0.0, 8.0}) {
        add_quad({x, 0, 0}, {x, 3, 0}, {x, 3, 3}, {x, 0, 3});
    }
    add_quad({3, 0, 0}, {3, 3, 0}, {3, 3, 1.1}, {3, 0, 1.1});
    add_quad({3, 0, 1.9}, {3, 3, 1.9}, {3, 3, 3}, {3, 0, 3});
    add_quad({3, 0, 1.1}, {3, 1.1, 1.1}, {3, 1.1, 1.9}, {3, 0, 1.9});
    add_quad({3, 1.9, 1.1}, {3, 3, 1.1}, {3, 3, 1.9}, {3, 1.9, 1.9});
    const OneMaterialScene scene(std::move(mesh), 0.2, 0.0);
    const double surface = 54.0 + 78.0 - 2.0 * 0.64;
    for (const double x : {1.2, 6.3}) {
        const std::array sources = {Vec3(x, 1.2, 0.7)};
        const RoomStatistics room = statistics(scene, sources);
        EXPECT_NEAR(room.volume, 72.0, 0.015 * 72.0) << x;
        EXPECT_NEAR(room.surface, surface, 1e-6) << x;
    }
}

TEST(RoomStatistics, AnOpeningAbsorbsAllThatMeetsIt) {
    // Without one of its walls of 6 x 3.5 m.
    Mesh mesh = box_mesh({8, 3.5, 6});
    mesh.triangles.resize(10);
    const OneMaterialScene scene(std::move(mesh), 0.2, 0.0);
    const std::array sources = {Vec3(2, 1.2, 1.5)};
    const RoomStatistics room = statistics(scene, sources);
    EXPECT_NEAR(room.surface, 173.0, 1e-6);
    EXPECT_NEAR(room.opening, 21.0, 0.03 * 21.0);
    EXPECT_NEAR(room.absorption[kBand], (0.2 * 173.0 + 21.0) / 194.0, 0.005);
    EXPECT_NEAR(room.volume, 168.0, 0.05 * 168.0);  // the shape of the opening is not known
}

TEST(RoomStatistics, AnOpenFieldIsNoRoom) {
    Mesh ground = box_mesh({100, 5, 100});
    ground.triangles = {ground.triangles[0], ground.triangles[1]};
    const OneMaterialScene scene(std::move(ground), 0.2, 0.0);
    const std::array sources = {Vec3(50, 1.2, 50)};
    EXPECT_FALSE(room_statistics(scene.scene(), sources).has_value());
    const std::array above = {Vec3(500, 1.2, 50)};
    EXPECT_FALSE(room_statistics(scene.scene(), above).has_value());
    EXPECT_FALSE(room_statistics(scene.scene(), {}).has_value());
}

TEST(RoomStatistics, BacksOfOneSidedSurfacesAbsorbAll) {
    Mesh mesh = box_mesh({6, 3, 4});
    append_box(mesh, {1, 0.5, 1}, {1, 2, 0.5});
    OneMaterialScene scene(std::move(mesh), 0.2, 0.0);
    const std::array sources = {Vec3(4, 1.2, 1.5)};
    scene.materials[0].one_sided = true;
    // The fronts of both boxes point inwards.
    const RoomStatistics room = statistics(scene, sources);
    EXPECT_NEAR(room.absorption[kBand], (0.2 * 108.0 + 7.0) / 115.0, 1e-9);
}

TEST(RoomStatistics, ThreadsDoNotMatter) {
    const OneMaterialScene scene(tessellated(box_mesh({8, 3.5, 6}), 10), 0.2, 0.0);
    const std::array sources = {Vec3(2, 1.2, 1.5), Vec3(3, 1, 2)};
    const RoomStatistics one = statistics(scene, sources, true);
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        const RoomStatistics many = statistics(scene, sources, true, executor);
        EXPECT_EQ(std::bit_cast<std::uint64_t>(one.volume),
                  std::bit_cast<std::uint64_t>(many.volume));
        EXPECT_EQ(one.surface, many.surface);
        EXPECT_EQ(one.sabine, many.sabine);
        EXPECT_EQ(one.eyring, many.eyring);
    }
}

}  // namespace
}  // namespace earshot::propagation
