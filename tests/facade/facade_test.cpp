// SPDX-License-Identifier: MIT
#include "earshot/earshot.h"
#include "earshot/io/wav.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <cmath>

namespace earshot::test {
namespace {

Room shoebox() {
    return load(source_file("scenes/shoebox.gltf"));
}

TEST(Facade, MakesOneResponsePerSourceAndListener) {
    Room room = shoebox();
    room.add_source("door", {1.0, 1.0, -0.5});
    room.add_listener("sofa", {2.0, 1.0, -1.5});
    const Responses responses = simulate(room, {.order = 1, .rays = 0});
    ASSERT_EQ(responses.size(), 4U);
    const Response& response = responses.at("door", "sofa");
    EXPECT_EQ(response.source, "door");
    EXPECT_EQ(response.listener, "sofa");
    ASSERT_EQ(response.paths.size(), 7U);  // direct and six walls
    EXPECT_NEAR(response.paths[0].length, std::sqrt(2.0), 1e-12);
    EXPECT_EQ(response.metrics.source, 1U);
    EXPECT_THROW(responses.at("door", "window"), Error);
}

TEST(Facade, WritesTheResponseAsAWavFile) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "response.wav";
    const Responses responses =
        simulate(shoebox(), {.order = 1, .rays = 0, .format = {.sample_rate = 16000.0}});
    const Response& response = *responses.begin();
    response.write_wav(file);
    const io::Sound sound = io::read_sound(file);
    EXPECT_EQ(sound.sample_rate, 16000.0);
    EXPECT_EQ(sound.channels, 1);
    ASSERT_EQ(sound.samples.size(), response.channels[0].samples.size());
    for (std::size_t n = 0; n < sound.samples.size(); ++n) {
        EXPECT_EQ(sound.samples[n], static_cast<float>(response.channels[0].samples[n]));
    }
}

TEST(Facade, TellsTheReverberationTimeOfARoomThatScatters) {
    Room room = shoebox();
    for (propagation::Material& material : room.scene.materials) {
        material.scattering = propagation::EnergyCoefficient(1.0);
        material.absorption = propagation::EnergyCoefficient(0.2);
    }
    const auto t30 = simulate(room, {.order = 1, .rays = 5000}).begin()->t30();
    ASSERT_TRUE(t30);
    // Eyring's formula for 8 x 3.5 x 6 m; the spread of free paths (Kuttruff 2009, section 5.5)
    // lengthens it by some 4 %.
    EXPECT_NEAR(*t30, 1.04 * 0.1613 * 168.0 / (-194.0 * std::log(0.8)), 0.04);
    EXPECT_FALSE(simulate(room, {.order = 0, .rays = 0}).begin()->t30());
}

TEST(Facade, AnswersForBothEarsAndAtATime) {
    const Responses responses =
        simulate(shoebox(),
                 {.order = 0, .rays = 0, .time = 1.0, .format = {.channels = Channels::binaural}});
    EXPECT_EQ(responses.begin()->channels.size(), 2U);
    EXPECT_EQ(responses.begin()->metrics.time, 1.0);
}

TEST(Facade, RefusesARoomWithoutSourcesOrListeners) {
    Room room = shoebox();
    room.scene.listeners.clear();
    EXPECT_THROW(simulate(room), Error);
    room = shoebox();
    room.scene.sources.clear();
    EXPECT_THROW(simulate(room), Error);
    EXPECT_THROW(load("no_such_file.gltf"), Error);
}

/// A wall across the x axis that falls from y = 1 to y = -9 within a second, and a floor at y = 0.
Room falling_wall() {
    geometry::Node node;
    node.name = "wall";
    node.translation = {.times = {0.0, 1.0}, .values = {0.0, 1.0, 0.0, 0.0, -9.0, 0.0}};
    geometry::Part wall, floor;
    wall.node = 0;
    wall.positions = {{0.0, 0.0, 0.0}, {0.0, 2.0, -2.0}, {0.0, 2.0, 2.0}};
    floor.positions = {{-5.0, 0.0, -4.0}, {-5.0, 0.0, 6.0}, {7.0, 0.0, 0.5}};
    Room room;
    room.scene.name = "falling wall";
    room.scene.mesh = geometry::AnimatedMesh({node}, {}, {wall, floor}, {{0, 1, 2}, {3, 4, 5}});
    room.scene.materials.resize(1);
    room.scene.material_of_triangle = {0, 0};
    return room;
}

TEST(Facade, LinesOfSightFollowTheGeometry) {
    Sight sight(falling_wall());
    const Vec3 left(-1.0, 2.0, 0.0), right(1.0, 2.0, 0.0);
    EXPECT_FALSE(sight.visible(left, right));
    sight.set_time(1.0);
    EXPECT_TRUE(sight.visible(left, right));
    EXPECT_FALSE(sight.visible(left, {-1.0, -1.0, 0.0}));
    sight.set_time(0.0);
    EXPECT_FALSE(sight.visible(right, left));
    EXPECT_TRUE(Sight(falling_wall(), 1.0).visible(left, right));
}

TEST(Facade, TellsWhenMovingPartsTouch) {
    World world(falling_wall());
    EXPECT_EQ(world.duration(), 1.0);
    EXPECT_TRUE(world.contacts(0.0, 0.05).empty());
    const auto contacts = world.contacts(0.0, 1.0);
    ASSERT_FALSE(contacts.empty());
    // The lowest corner falls 10 m and meets the floor after the first.
    EXPECT_NEAR(contacts.front().toi, 0.1, 1e-9);
    EXPECT_LE(contacts.front().toi, 0.1);
    EXPECT_EQ(contacts.front().kind, collision::ContactKind::vertex_face);
    EXPECT_EQ(world.name_of(contacts.front().a.mesh), "wall");
    EXPECT_EQ(world.name_of(contacts.front().b.mesh), "");
}

TEST(Facade, LeavesOutContactsOfPartsThatRest) {
    Room room = falling_wall();
    World world(room);
    EXPECT_FALSE(world.contacts(0.05, 0.2).empty());
    // After its last key the wall rests, deep in the floor.
    EXPECT_TRUE(world.contacts(1.0, 2.0).empty());
}

}  // namespace
}  // namespace earshot::test
