// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/screw_ccd.h"

#include "earshot/collision/narrow_phase/triangle_distance.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/dice.h"
#include <cmath>

namespace earshot::collision {
namespace {

using geometry::Vec3;
using support::Dice;

constexpr double kClose = 1e-8;  // metres, and of the step: the tolerance of searches

TEST(ScrewCcd, APointOnAnArcReachesAWallWhenItsSineDoes) {
    for (const double angle : {0.01, 0.5, 1.5, 3.0}) {
        const Screw screw{.axis = {0.0, 1.0, 0.0}, .angle = angle};
        const double wall = 2.0 * std::sin(0.6 * std::min(angle, 1.5));
        const ScrewPoints points{
            .begin = {Vec3(2.0, 0.0, 0.0), {-9, -9, -wall}, {9, -9, -wall}, {0, 20, -wall}},
            .end = {Vec3(0.0), {-9, -9, -wall}, {9, -9, -wall}, {0, 20, -wall}},
            .first = &screw};
        const auto toi = vertex_face_screw_ccd(points, 0.0);
        ASSERT_TRUE(toi) << angle;
        const double expected = std::asin(wall / 2.0) / angle;
        EXPECT_LE(*toi, expected) << angle;
        // The features are 36 m wide: a billionth of that at 2 m per radian.
        EXPECT_NEAR(*toi, expected, 2e-7 / angle) << angle;
    }
}

TEST(ScrewCcd, ARodMeetsAPostWhenItPointsThere) {
    const Screw screw{.point = {0.3, 0.0, 0.1}, .axis = {0.0, 1.0, 0.0}, .angle = 2.0};
    const double phi = 1.3;
    const Vec3 foot = screw.point + 1.5 * Vec3(std::cos(phi), 0.0, -std::sin(phi));
    const ScrewPoints points{
        .begin = {screw.point,
                  screw.point + Vec3(2.0, 0.0, 0.0),
                  foot - Vec3(0, 1, 0),
                  foot + Vec3(0, 1, 0)},
        .end = {Vec3(0.0), Vec3(0.0), foot - Vec3(0, 1, 0), foot + Vec3(0, 1, 0)},
        .first = &screw};
    const auto toi = edge_edge_screw_ccd(points, 0.0);
    ASSERT_TRUE(toi);
    EXPECT_LE(*toi, phi / 2.0);
    EXPECT_NEAR(*toi, phi / 2.0, kClose);
    // A post that is farther away than the rod is long.
    ScrewPoints beyond = points;
    for (const std::size_t i : {2, 3}) {
        beyond.begin[i] += 0.6 * (foot - screw.point);
        beyond.end[i] = beyond.begin[i];
    }
    EXPECT_FALSE(edge_edge_screw_ccd(beyond, 0.0));
    EXPECT_TRUE(edge_edge_screw_ccd(beyond, 0.5));
}

/// How far the features are apart at a time.
double distance_at(const ScrewPoints& points, std::size_t first_points, double time) {
    const auto at = [&](std::size_t i) { return points.at(i, first_points, time); };
    return first_points == 1 ? distance({at(0), at(0), at(0)}, {at(1), at(2), at(3)}).distance
                             : distance({at(0), at(1), at(1)}, {at(2), at(3), at(3)}).distance;
}

TEST(ScrewCcd, FindsTheFirstTimeOfRandomScrews) {
    Dice dice(5);
    const auto random = [&](double size) {
        return size *
               Vec3(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0));
    };
    std::size_t hits = 0, misses = 0;
    for (int round = 0; round < 400; ++round) {
        const auto screw = [&] {
            return Screw{.point = random(1.0),
                         .axis = glm::normalize(random(1.0)),
                         .angle = dice.between(0.1, 3.0),
                         .slide = dice.between(-1.0, 1.0)};
        };
        const Screw one = screw(), other = screw();
        ScrewPoints points{.first = &one, .second = round % 3 == 0 ? nullptr : &other};
        for (std::size_t i = 0; i < 4; ++i) {
            points.begin[i] = random(1.0);
            points.end[i] = points.begin[i] + random(0.5);
        }
        const std::size_t first = round % 2 == 0 ? 1 : 2;
        const auto toi =
            first == 1 ? vertex_face_screw_ccd(points, 0.0) : edge_edge_screw_ccd(points, 0.0);
        // Samples before it are apart, and they are together at it; without one all are apart.
        constexpr int kSamples = 1000;
        double closest = 1e300;
        for (int i = 0; i <= kSamples; ++i) {
            const double time = i / double(kSamples);
            if (!toi || time < *toi) {
                closest = std::min(closest, distance_at(points, first, time));
            }
        }
        if (toi) {
            ++hits;
            EXPECT_LE(distance_at(points, first, *toi), 1e-7) << round;
            EXPECT_GT(closest, 0.0) << round;
        } else {
            ++misses;
            EXPECT_GT(closest, 1e-6) << round;
        }
    }
    EXPECT_GT(hits, 30U);
    EXPECT_GT(misses, 100U);
}

}  // namespace
}  // namespace earshot::collision
