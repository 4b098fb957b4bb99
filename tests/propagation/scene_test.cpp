// SPDX-License-Identifier: MIT
#include "earshot/propagation/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

void expect_near(const Vec3& found, const Vec3& expected) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(found[axis], expected[axis], 1e-12) << axis;
    }
}

TEST(Pose, LooksAlongMinusZUnlessTold) {
    const Scene scene;
    const Pose pose = scene.pose_at({.name = "l", .position = {1, 2, 3}}, 0.0);
    expect_near(pose.front, {0, 0, -1});
    expect_near(pose.left, {-1, 0, 0});
    expect_near(pose.up, {0, 1, 0});
    const Pose turned =
        scene.pose_at({.name = "l", .position = {1, 2, 3}, .looks_at = Vec3(5, 2, 3)}, 0.0);
    expect_near(turned.front, {1, 0, 0});
    expect_near(turned.left, {0, 0, -1});
    expect_near(turned.seen_from({1, 0, 0}), {1, 0, 0});
    expect_near(turned.seen_from({0, 0, -1}), {0, 1, 0});
}

TEST(Pose, IsARightHandedFrameWhereverItLooks) {
    for (const Vec3& front : {Vec3(0, 1, 0), Vec3(0, -3, 0), Vec3(1, 2, -3), Vec3(0.0)}) {
        for (const Vec3& up : {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.0), Vec3(NAN)}) {
            const Pose pose = pose_towards({}, front, up);
            EXPECT_NEAR(glm::length(pose.front), 1.0, 1e-12);
            EXPECT_NEAR(glm::length(pose.left), 1.0, 1e-12);
            EXPECT_NEAR(glm::dot(pose.front, pose.left), 0.0, 1e-12);
            expect_near(glm::cross(pose.front, pose.left), pose.up);
        }
    }
}

Scene scene_of(const std::vector<std::string>& sources, const std::vector<std::string>& listeners) {
    Scene scene;
    for (const std::string& name : sources) {
        scene.sources.push_back({.name = name});
    }
    for (const std::string& name : listeners) {
        scene.listeners.push_back({.name = name});
    }
    return scene;
}

TEST(PairKey, FollowsTheNamesWhateverElseThereIs) {
    const Scene few = scene_of({"s"}, {"a"});
    const Scene many = scene_of({"t", "s"}, {"b", "c", "a"});
    EXPECT_EQ(pair_key(few, 0, 0), pair_key(many, 1, 2));
    EXPECT_NE(pair_key(many, 0, 2), pair_key(many, 1, 2));
    EXPECT_NE(pair_key(many, 1, 0), pair_key(many, 1, 1));
    EXPECT_NE(pair_key(few, 0, 0), pair_key(scene_of({"a"}, {"s"}), 0, 0));
}

TEST(PairKey, TellsEqualNamesApart) {
    const Scene scene = scene_of({"", ""}, {"a", "a"});
    EXPECT_NE(pair_key(scene, 0, 0), pair_key(scene, 0, 1));
    EXPECT_NE(pair_key(scene, 0, 0), pair_key(scene, 1, 0));
    EXPECT_NE(pair_key(scene, 0, 1), pair_key(scene, 1, 0));
}

}  // namespace
}  // namespace earshot::propagation
