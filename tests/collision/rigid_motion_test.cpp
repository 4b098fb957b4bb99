// SPDX-License-Identifier: MIT
#include "earshot/collision/rigid_motion.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <cmath>

namespace earshot::collision {
namespace {

using geometry::Vec3;
using support::Dice;

Vec3 somewhere(Dice& dice, double size) {
    return {dice.between(-size, size), dice.between(-size, size), dice.between(-size, size)};
}

Screw some_screw(Dice& dice) {
    return {.point = somewhere(dice, 3.0),
            .axis = glm::normalize(somewhere(dice, 1.0)),
            .angle = dice.between(-8.0, 8.0),
            .slide = dice.chance(0.5) ? dice.between(-2.0, 2.0) : 0.0};
}

void expect_same(const Pose& is, const Pose& should_be, double error) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(glm::length(is.rotation[k] - should_be.rotation[k]), error);
    }
    EXPECT_LE(glm::length(is.translation - should_be.translation), error);
}

Pose after(const Pose& first, const Pose& then) {
    return {then.rotation * first.rotation, then.apply(first.translation)};
}

TEST(Screw, TurnsRightHandedAndSlides) {
    const Screw quarter{
        .point = {1.0, 0.0, 0.0}, .axis = {0.0, 0.0, 1.0}, .angle = math::kPi / 2.0, .slide = 3.0};
    const Vec3 moved = quarter.at(1.0).apply({2.0, 0.0, 0.0});
    EXPECT_LE(glm::length(moved - Vec3(1.0, 1.0, 3.0)), 1e-15);
    const Vec3 halfway = quarter.at(0.5).apply({2.0, 0.0, 0.0});
    EXPECT_LE(glm::length(halfway - Vec3(1.0 + std::sqrt(0.5), std::sqrt(0.5), 1.5)), 1e-15);
}

TEST(Screw, GoesFromAnyPoseToAnyOther) {
    Dice dice(3);
    for (int i = 0; i < 2000; ++i) {
        const Pose from = some_screw(dice).at(1.0);
        Screw way = some_screw(dice);
        if (i % 4 == 1) {
            way.angle = math::kPi;  // where the axis is hard to tell
        } else if (i % 4 == 2) {
            way.angle = math::kPi - dice.between(0.0, 1e-7);
        } else if (i % 4 == 3) {
            way.angle = dice.between(0.0, 1e-6);
        }
        const Pose to = after(from, way.at(1.0));
        const Screw found = Screw::between(from, to);
        EXPECT_LE(std::fabs(found.angle), math::kPi * (1.0 + 1e-15));
        EXPECT_NEAR(glm::length(found.axis), 1.0, 1e-12);
        expect_same(after(from, found.at(1.0)), to, 1e-8);
    }
}

TEST(Screw, IsASlideWithoutTurnAndRefusesWhatIsNotRigid) {
    const Pose from{};
    const Pose to{.translation = {0.0, 3.0, 4.0}};
    const Screw screw = Screw::between(from, to);
    EXPECT_EQ(screw.angle, 0.0);
    EXPECT_EQ(screw.slide, 5.0);
    EXPECT_EQ(Screw::between(from, from).slide, 0.0);
    EXPECT_THROW(Screw::between(from, {.rotation = glm::dmat3(2.0)}), Error);
    EXPECT_THROW(Screw::between({.rotation = glm::dmat3(-1.0)}, from), Error);
    EXPECT_THROW(Screw::between(from, {.translation = Vec3(NAN)}), Error);
}

TEST(RigidMotion, ChordsStayWithinTheTolerance) {
    Dice dice(5);
    double tightest = 0.0;
    for (int i = 0; i < 60; ++i) {
        RigidMotion motion{.start = some_screw(dice).at(1.0)};
        for (int joint = 0; joint <= i % 4; ++joint) {
            motion.screws.push_back(some_screw(dice));
        }
        const std::vector<Vec3> points{somewhere(dice, 1.0), somewhere(dice, 1.0)};
        const double tolerance = dice.between(1e-3, 0.1);
        const double steps = linear_step_count(motion.acceleration_bound(points), tolerance);
        for (double step = 0.0; step < std::min(steps, 50.0); step += 1.0) {
            const Pose begin = motion.at(step / steps);
            const Pose end = motion.at((step + 1.0) / steps);
            for (const double within : {0.2, 0.5, 0.7}) {
                const Pose true_pose = motion.at((step + within) / steps);
                for (const Vec3& point : points) {
                    const Vec3 chord =
                        (1.0 - within) * begin.apply(point) + within * end.apply(point);
                    const double error = glm::length(chord - true_pose.apply(point));
                    EXPECT_LE(error, tolerance);
                    tightest = std::max(tightest, error / tolerance);
                }
            }
        }
    }
    // For a turn alone the bound is sharp, but for the fraction of a step that is left over.
    EXPECT_GT(tightest, 0.9);
}

TEST(RigidMotion, StraightMotionIsOneStep) {
    const RigidMotion slide{.screws = {{.slide = 5.0}, {.axis = {1.0, 0.0, 0.0}, .slide = 2.0}}};
    const std::vector<Vec3> points{{1.0, 2.0, 3.0}};
    EXPECT_EQ(slide.acceleration_bound(points), 0.0);
    EXPECT_EQ(linear_step_count(0.0, 1e-9), 1.0);
    EXPECT_EQ(RigidMotion{}.acceleration_bound(points), 0.0);
    expect_same(slide.at(0.5), {.translation = {1.0, 2.5, 0.0}}, 0.0);
    // A whole turn of radius 1 with a sagitta of 1 mm: 1 - cos(pi / n) <= 0.001.
    EXPECT_EQ(linear_step_count(4.0 * math::kPi * math::kPi, 1e-3), 71.0);
}

}  // namespace
}  // namespace earshot::collision
