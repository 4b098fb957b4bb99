// SPDX-License-Identifier: MIT
#include "earshot/geometry/track.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace earshot::geometry {
namespace {

double sample_one(const Track& track, double t) {
    double value = 0.0;
    track.sample(t, {&value, 1}, false);
    return value;
}

glm::dquat about_y(double angle) {
    return {std::cos(angle / 2.0), 0.0, std::sin(angle / 2.0), 0.0};
}

TEST(Track, StepHoldsEachKeyUntilTheNext) {
    const Track track{Interpolation::step, {1.0, 2.0, 4.0}, {10.0, 20.0, 40.0}};
    EXPECT_EQ(sample_one(track, 0.0), 10.0);
    EXPECT_EQ(sample_one(track, 1.999), 10.0);
    EXPECT_EQ(sample_one(track, 2.0), 20.0);
    EXPECT_EQ(sample_one(track, 4.0), 40.0);
    EXPECT_EQ(sample_one(track, 9.0), 40.0);
}

TEST(Track, LinearMixesNeighboursAndHoldsTheEnds) {
    const Track track{Interpolation::linear, {1.0, 2.0, 4.0}, {10.0, 20.0, 40.0}};
    EXPECT_EQ(sample_one(track, 0.0), 10.0);
    EXPECT_EQ(sample_one(track, 1.5), 15.0);
    EXPECT_EQ(sample_one(track, 2.0), 20.0);
    EXPECT_EQ(sample_one(track, 2.5), 25.0);
    EXPECT_EQ(sample_one(track, 5.0), 40.0);
}

TEST(Track, CubicSplineReproducesACubic) {
    // A Hermite spline with the derivative as tangents is the cubic itself: x(t) = t^3 - 2 t.
    Track track{Interpolation::cubic_spline, {}, {}};
    for (const double t : {0.0, 0.5, 2.0, 3.5}) {
        track.times.push_back(t);
        const double slope = 3.0 * t * t - 2.0;
        track.values.insert(track.values.end(), {slope, t * t * t - 2.0 * t, slope});
    }
    for (double t = 0.0; t <= 3.5; t += 0.0625) {
        EXPECT_NEAR(sample_one(track, t), t * t * t - 2.0 * t, 1e-13) << "t = " << t;
    }
}

TEST(Track, RotationTakesTheShorterArc) {
    const glm::dquat a = about_y(0.2);
    const glm::dquat b = -about_y(1.4);  // the same rotation, the far quaternion
    const Track track{Interpolation::linear, {0.0, 1.0}, {a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w}};
    std::array<double, 4> q{};
    track.sample(0.25, q, true);
    EXPECT_NEAR(q[1], std::sin(0.25), 1e-15);  // half of 0.2 + 0.25 * 1.2
    EXPECT_NEAR(q[3], std::cos(0.25), 1e-15);
}

TEST(Track, CubicRotationIsNormalised) {
    const glm::dquat a = about_y(0.0);
    const glm::dquat b = about_y(2.0);
    Track track{Interpolation::cubic_spline, {0.0, 1.0}, std::vector<double>(24, 0.0)};
    for (int i = 0; i < 4; ++i) {
        const auto k = static_cast<std::size_t>(i);
        track.values[4 + k] = a[i];
        track.values[16 + k] = b[i];
    }
    std::array<double, 4> q{};
    track.sample(0.5, q, true);
    EXPECT_NEAR(q[1], std::sin(0.5), 1e-15);  // equal shares: half way, angle 1
    EXPECT_NEAR(q[3], std::cos(0.5), 1e-15);
}

TEST(Track, CubicRotationThroughZeroKeepsAUnitLength) {
    Track track{Interpolation::cubic_spline, {0.0, 1.0}, std::vector<double>(24, 0.0)};
    track.values[4 + 3] = 1.0;
    track.values[16 + 3] = -1.0;
    std::array<double, 4> q{};
    track.sample(0.5, q, true);
    EXPECT_EQ(q[3], 1.0);
}

TEST(Slerp, MatchesTheAngleItIsMadeFrom) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const double from = random_between(seed, 0, 0, -3.0, 3.0);
        const double by = random_between(seed, 1, 0, -3.1, 3.1);  // below pi: no shorter way round
        const double fraction = random(seed, 2, 0);
        const glm::dquat got = slerp(about_y(from), about_y(from + by), fraction);
        const glm::dquat want = about_y(from + fraction * by);
        const double sign = got.w * want.w + got.y * want.y < 0.0 ? -1.0 : 1.0;
        EXPECT_NEAR(got.w, sign * want.w, 1e-14) << "seed " << seed;
        EXPECT_NEAR(got.y, sign * want.y, 1e-14) << "seed " << seed;
    }
}

TEST(Slerp, IsExactForEqualRotationsAndSmoothForNearOnes) {
    const glm::dquat a = about_y(0.7);
    EXPECT_EQ(slerp(a, a, 0.3), a);
    const glm::dquat got = slerp(about_y(0.7), about_y(0.7 + 1e-9), 0.5);
    EXPECT_NEAR(got.y, std::sin(0.35 + 0.25e-9), 2e-16);
}

TEST(Transform, ScalesThenRotatesThenTranslates) {
    const Transform transform{{1.0, 2.0, 3.0}, about_y(math::kPi / 2.0), {2.0, 3.0, 4.0}};
    // x axis scaled to 2, turned about +Y by 90 degrees: to -z.
    const Vec3 moved = transform_point(transform.matrix(), {1.0, 1.0, 0.0});
    EXPECT_NEAR(moved.x, 1.0, 1e-15);
    EXPECT_EQ(moved.y, 5.0);
    EXPECT_NEAR(moved.z, 1.0, 1e-15);
}

TEST(Transform, IdentityIsExact) {
    EXPECT_EQ(Transform{}.matrix(), glm::dmat4(1.0));
    const Vec3 p{0.1, -1e12, 3e-300};
    EXPECT_EQ(transform_point(Transform{}.matrix(), p), p);
}

}  // namespace
}  // namespace earshot::geometry
