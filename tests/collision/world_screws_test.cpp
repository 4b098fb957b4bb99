// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "support/box.h"
#include <cmath>
#include <string>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::AnimatedMesh;
using geometry::Interpolation;
using geometry::Node;
using geometry::Part;
using geometry::Track;
using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

constexpr double kPi = 3.141592653589793;

Part box(int node, const Vec3& low, const Vec3& high) {
    Part part;
    part.node = node;
    for (int i = 0; i < 8; ++i) {
        part.positions.emplace_back((i & 1) != 0 ? high.x : low.x,
                                    (i & 2) != 0 ? high.y : low.y,
                                    (i & 4) != 0 ? high.z : low.z);
    }
    return part;
}

std::vector<Triangle> triangles_of_boxes(std::size_t boxes) {
    const std::vector<Triangle> one = test::box_triangles();
    std::vector<Triangle> all;
    for (std::size_t i = 0; i < boxes; ++i) {
        for (const auto& [a, b, c] : one) {
            const auto first = static_cast<VertexId>(8 * i);
            all.push_back({a + first, b + first, c + first});
        }
    }
    return all;
}

/// Keys of a turn about y at a constant rate, `keys` of them in a second.
Track turn(double angle, int keys) {
    Track track{Interpolation::linear, {}, {}};
    for (int i = 0; i <= keys; ++i) {
        const double half = 0.5 * angle * i / keys;
        track.times.push_back(i / double(keys));
        track.values.insert(track.values.end(), {0.0, std::sin(half), 0.0, std::cos(half)});
    }
    return track;
}

/// A rod along x that turns about y, and a post in its way at an angle.
AnimatedMesh rotor(double angle, int keys, double post_angle) {
    Node rod, post;
    rod.name = "rod";
    rod.rotation = turn(angle, keys);
    post.rest.translation = 1.5 * Vec3(std::cos(post_angle), 0.0, -std::sin(post_angle));
    return AnimatedMesh({rod, post},
                        {},
                        {box(0, {0.0, -0.1, -0.01}, {2.0, 0.1, 0.01}),
                         box(1, {-0.02, -1.0, -0.02}, {0.02, 1.0, 0.02})},
                        triangles_of_boxes(2));
}

/// When the rod's side first reaches a corner of the post.
double expected_angle(double post_angle) {
    double first = 1e300;
    for (const double dx : {-0.02, 0.02}) {
        for (const double dz : {-0.02, 0.02}) {
            const double x = 1.5 * std::cos(post_angle) + dx;
            const double z = -1.5 * std::sin(post_angle) + dz;
            const double r = std::hypot(x, z);
            first = std::min(first, std::atan2(-z, x) - std::asin(0.01 / r));
        }
    }
    return first;
}

double first_time(World& world, double t0, double t1, Path path) {
    world.set_step(t0, t1, path);
    const auto contact = world.first_contact();
    return contact ? t0 + contact->toi * (t1 - t0) : -1.0;
}

TEST(WorldOnScrews, ATurningRodReachesThePostAtItsAngle) {
    for (const double angle : {0.4, 1.5, 3.0}) {
        const double post = 0.7 * angle;
        World world;
        world.add(rotor(angle, 1, post));
        const double expected = expected_angle(post) / angle;
        const double found = first_time(world, 0.0, 1.0, Path::screws);
        EXPECT_LE(found, expected) << angle;
        EXPECT_NEAR(found, expected, 1e-7) << angle;
        // The same in several steps, and at the end of them.
        double in_steps = -1.0;
        for (int i = 0; i < 10 && in_steps < 0.0; ++i) {
            in_steps = first_time(world, 0.1 * i, 0.1 * (i + 1), Path::screws);
        }
        EXPECT_NEAR(in_steps, expected, 1e-7) << angle;
        EXPECT_NEAR(world.turn(0, 0.0, 1.0), angle, 1e-6);
        EXPECT_EQ(world.turn(1, 0.0, 1.0), 0.0);
        EXPECT_TRUE(world.moves(0));
        EXPECT_FALSE(world.moves(1));
    }
}

TEST(WorldOnScrews, AStepOfManyTurnsIsSplit) {
    // Half a circle has two ways, a whole one none: what lies between tells.
    for (const double angle : {kPi, 2.0 * kPi, 6.0 * kPi}) {
        World world;
        world.add(rotor(angle, 24, 2.5));
        const double expected = expected_angle(2.5) / angle;
        const double found = first_time(world, 0.0, 1.0, Path::screws);
        EXPECT_LE(found, expected + 1e-12) << angle;
        EXPECT_NEAR(found, expected, 1e-6) << angle;
        EXPECT_NEAR(world.turn(0, 0.0, 1.0), angle, 1e-6) << angle;
    }
}

TEST(WorldOnScrews, SlidesAndDeformationsAreThoseOfChords) {
    Node slider, still;
    slider.translation = {Interpolation::linear, {0.0, 1.0}, {0.0, 3.0, 0.0, 0.3, 0.0, 0.1}};
    still.scale = {Interpolation::linear, {0.0, 1.0}, {1.0, 1.0, 1.0, 1.0, 1.5, 1.0}};
    const AnimatedMesh mesh({slider, still},
                            {},
                            {box(0, {-1, -1, -1}, {1, 1, 1}), box(1, {-1, -1, -1}, {1, 1, 1})},
                            triangles_of_boxes(2));
    World chords, screws;
    chords.add(mesh);
    screws.add(mesh);
    chords.set_step(0.0, 1.0);
    screws.set_step(0.0, 1.0, Path::screws);
    const auto expected = chords.contacts(), found = screws.contacts();
    ASSERT_FALSE(expected.empty());
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].a, expected[i].a);
        EXPECT_EQ(found[i].b, expected[i].b);
        EXPECT_EQ(found[i].toi, expected[i].toi);
        EXPECT_EQ(found[i].point, expected[i].point);
    }
}

TEST(WorldOnScrews, PartsOfOneJointDoNotTouchWhileTheyTurnTogether) {
    // Two boxes a micrometre apart on one node's children.
    Node joint, a, b;
    joint.rotation = turn(1.5, 1);
    a.parent = b.parent = 0;
    World world;
    world.add(AnimatedMesh({joint, a, b},
                           {},
                           {box(1, {0, 0, 0}, {1, 1, 1}), box(2, {1.000001, 0, 0}, {2, 1, 1})},
                           triangles_of_boxes(2)));
    EXPECT_EQ(first_time(world, 0.0, 1.0, Path::screws), -1.0);
    // Touching ones touch at the beginning.
    World touching;
    touching.add(AnimatedMesh({joint, a, b},
                              {},
                              {box(1, {0, 0, 0}, {1, 1, 1}), box(2, {1, 0, 0}, {2, 1, 1})},
                              triangles_of_boxes(2)));
    EXPECT_EQ(first_time(touching, 0.0, 1.0, Path::screws), 0.0);
}

TEST(WorldOnScrews, ArmOfTwoJointsIsWhereFineStepsHaveIt) {
    Node shoulder, elbow, wall;
    shoulder.rotation = turn(1.2, 1);
    elbow.parent = 0;
    elbow.rest.translation = {1.0, 0.0, 0.0};
    elbow.translation = {Interpolation::linear, {0.0}, {1.0, 0.0, 0.0}};
    elbow.rotation = turn(1.7, 1);
    const AnimatedMesh mesh({shoulder, elbow, wall},
                            {},
                            {box(1, {0.0, -0.1, -0.05}, {1.0, 0.1, 0.05}),
                             box(2, {-0.5, -0.5, -2.0}, {1.1, 0.5, -1.6})},
                            triangles_of_boxes(2));
    World world, fine;
    world.add(mesh);
    fine.add(mesh);
    double expected = -1.0;
    constexpr int kSteps = 500;
    for (int i = 0; i < kSteps && expected < 0.0; ++i) {
        expected = first_time(fine, i / double(kSteps), (i + 1) / double(kSteps), Path::chords);
    }
    ASSERT_GT(expected, 0.1);
    EXPECT_NEAR(first_time(world, 0.0, 1.0, Path::screws), expected, 1e-3);
}

}  // namespace
}  // namespace earshot::collision
