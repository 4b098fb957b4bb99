// SPDX-License-Identifier: MIT
#include "earshot/collision/rigid_contacts.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"

#include <gtest/gtest.h>

#include <cmath>

namespace earshot::collision {
namespace {

using geometry::Mesh;
using geometry::Vec3;

/// A door that hangs on the y axis and stands along x.
Mesh door() {
    return {{{0.0, -1.0, 0.0}, {2.0, -1.0, 0.0}, {2.0, 1.0, 0.0}, {0.0, 1.0, 0.0}},
            {{0, 1, 2}, {0, 2, 3}}};
}

/// A pyramid whose tip a door that opens by `angle` intersects at `radius` from its hinge.
Mesh pyramid(double angle, double radius) {
    const auto at = [&](double a, double r, double y) {
        return Vec3(r * std::cos(a), y, -r * std::sin(a));
    };
    return {{at(angle, radius, 0.1),
             at(angle + 0.3, radius, 0.5),
             at(angle + 0.3, radius - 0.5, -0.5),
             at(angle + 0.3, radius + 0.5, -0.5)},
            {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 2, 3}}};
}

RigidMotion opening(double angle) {
    return {.screws = {{.angle = angle}}};
}

TEST(FirstContact, OfADoorIsAtTheAngleItSeems) {
    const Mesh leaf = door();
    for (const double angle : {0.3, 1.5, 2.9, 5.0}) {
        for (const double tolerance : {1e-2, 1e-4}) {
            const Mesh obstacle = pyramid(angle, 1.2);
            const std::vector<MovingBody> bodies{{leaf.view(), opening(6.0)}, {obstacle.view()}};
            const auto contact = first_contact(bodies, {.tolerance = tolerance});
            ASSERT_TRUE(contact);
            EXPECT_LE(contact->toi, angle / 6.0);
            EXPECT_GE(contact->toi, (angle - 2.0 * tolerance / 1.2) / 6.0);
            EXPECT_EQ(contact->a.mesh + contact->b.mesh, 1U);
            const std::vector<MovingBody> short_way{{leaf.view(), opening(angle - 0.05)},
                                                    {obstacle.view()}};
            EXPECT_FALSE(first_contact(short_way, {.tolerance = tolerance}));
            EXPECT_TRUE(first_contact(short_way, {.min_separation = 0.08, .tolerance = tolerance}));
        }
    }
}

TEST(FirstContact, FollowsJointsOneAfterTheOther) {
    // The outer joint turns back as fast as the inner one turns: the door keeps its direction.
    const Mesh leaf = door();
    const RigidMotion parallel{
        .screws = {{.angle = 1.0}, {.point = {1.0, 0.0, 0.0}, .angle = -1.0}}};
    const Mesh obstacle{{{0.5, -0.5, -1.5}, {1.5, -0.5, -1.5}, {1.0, 0.5, -0.6}}, {{0, 1, 2}}};
    const std::vector<MovingBody> bodies{{leaf.view(), parallel}, {obstacle.view()}};
    // The hinge of the outer joint runs on the unit circle, and with it the whole door.
    const auto contact = first_contact(bodies, {.tolerance = 1e-4});
    ASSERT_TRUE(contact);
    EXPECT_LE(contact->toi, std::asin(0.6));
    EXPECT_GT(contact->toi, std::asin(0.6) - 5e-4);
}

TEST(FirstContact, SaysWhatMeetsAtTheBeginningAndLeavesOutWhatRests) {
    const Mesh leaf = door();
    const Mesh through = pyramid(-0.1, 1.2);
    const std::vector<MovingBody> moving{{leaf.view(), opening(1.0)}, {through.view()}};
    const auto contact = first_contact(moving);
    ASSERT_TRUE(contact);
    EXPECT_EQ(contact->toi, 0.0);
    EXPECT_EQ(contact->kind, ContactKind::triangle_triangle);
    const std::vector<MovingBody> resting{{leaf.view()}, {through.view()}};
    EXPECT_FALSE(first_contact(resting));
    EXPECT_FALSE(first_contact(moving, {.filter = [](auto, auto) { return false; }}));
    EXPECT_FALSE(first_contact({}));
}

TEST(FirstContact, OfASlideIsExact) {
    const Mesh leaf = door();
    const RigidMotion slide{.screws = {{.axis = {0.0, 0.0, -1.0}, .slide = 4.0}}};
    const Mesh tip{{{1.0, 0.1, -3.0}, {0.5, 0.5, -5.0}, {1.5, 0.5, -5.0}}, {{0, 1, 2}}};
    const std::vector<MovingBody> bodies{{leaf.view(), slide}, {tip.view()}};
    const auto contact = first_contact(bodies, {.tolerance = 1.0});
    ASSERT_TRUE(contact);
    EXPECT_LE(contact->toi, 0.75);
    EXPECT_GT(contact->toi, 0.75 - 1e-11);
}

TEST(FirstContact, RefusesWhatCannotBe) {
    const Mesh leaf = door();
    const std::vector<MovingBody> bodies{{leaf.view(), opening(1.0)}};
    EXPECT_THROW(first_contact(bodies, {.tolerance = 0.0}), Error);
    EXPECT_THROW(first_contact(bodies, {.tolerance = NAN}), Error);
    EXPECT_THROW(first_contact(bodies, {.min_separation = -1.0}), Error);
    EXPECT_THROW(first_contact(bodies, {.tolerance = 1e-30}), Error);
}

}  // namespace
}  // namespace earshot::collision
