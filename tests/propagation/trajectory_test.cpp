// SPDX-License-Identifier: MIT
#include "earshot/propagation/trajectory.h"

#include "earshot/base/error.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

TEST(Trajectory, KeepsConstantAcceleration) {
    const auto place = [](double t) { return Vec3(1.0 + 2.0 * t - 3.0 * t * t, t, 4.0); };
    std::vector<TrajectoryKey> keys;
    for (const double t : {0.0, 0.1, 0.4, 0.5, 1.1}) {
        keys.push_back({t, place(t)});
    }
    const Trajectory trajectory(keys);
    double fastest = 0.0;
    for (double t = 0.0; t < 1.1; t += 0.013) {
        const Motion motion = trajectory.at(t);
        EXPECT_NEAR(glm::distance(motion.position, place(t)), 0.0, 1e-14) << t;
        EXPECT_NEAR(glm::distance(motion.velocity, Vec3(2.0 - 6.0 * t, 1.0, 0.0)), 0.0, 1e-13) << t;
        fastest = std::max(fastest, glm::length(motion.velocity));
    }
    EXPECT_GE(trajectory.max_speed(), fastest);
    EXPECT_LE(trajectory.max_speed(), 1.1 * fastest);
    EXPECT_EQ(trajectory.at(-1.0).position, place(0.0));
    EXPECT_EQ(trajectory.at(-1.0).velocity, Vec3(0.0));
    EXPECT_EQ(trajectory.at(2.0).position, place(1.1));
}

TEST(Trajectory, FollowsACircleClosely) {
    std::vector<TrajectoryKey> keys;
    for (int k = 0; k <= 100; ++k) {
        const double t = 0.02 * k;
        keys.push_back({t, Vec3(3.0 * std::cos(t), 0.0, 3.0 * std::sin(t))});
    }
    const Trajectory trajectory(keys);
    for (double t = 0.1; t < 1.9; t += 0.0137) {
        const Vec3 place(3.0 * std::cos(t), 0.0, 3.0 * std::sin(t));
        EXPECT_NEAR(glm::distance(trajectory.at(t).position, place), 0.0, 2e-6) << t;
    }
}

TEST(Trajectory, RefusesWhatIsNoWay) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Trajectory(std::vector<TrajectoryKey>{}), Error);
    EXPECT_THROW(Trajectory({{0.0, Vec3(0.0)}, {0.0, Vec3(1.0)}}), Error);
    EXPECT_THROW(Trajectory({{1.0, Vec3(0.0)}, {0.0, Vec3(1.0)}}), Error);
    EXPECT_THROW(Trajectory({{kNan, Vec3(0.0)}}), Error);
    EXPECT_THROW(Trajectory({{0.0, Vec3(kNan)}}), Error);
}

}  // namespace
}  // namespace earshot::propagation
