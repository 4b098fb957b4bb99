// SPDX-License-Identifier: MIT
// Against contacts that are made to measure in exact numbers, against distances by sampling, and
// the filters against integers.
#include "earshot/collision/moving_points.h"

#include "earshot/collision/internal/exact_contact.h"
#include "earshot/collision/rational_points.h"
#include "earshot/collision/separation.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "made_queries.h"
#include "support/dice.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::collision {
namespace {

using geometry::Vec3;
using support::Dice;

Vec3 random_point(Dice& dice) {
    return {dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0)};
}

std::optional<double> time_of(const MovingPoints& points, bool is_face) {
    return is_face ? vertex_face_time(points) : edge_edge_time(points);
}

std::optional<double> exact_time_of(const MovingPoints& points, bool is_face) {
    const IntegerPoints integers = integers_of(points);
    return is_face ? exact_vertex_face_time(integers) : exact_edge_edge_time(integers);
}

void expect_neither_missed_nor_late(std::uint64_t seed, int count) {
    Dice dice(seed);
    for (int i = 0; i < count; ++i) {
        const bool is_face = i % 2 == 0;
        const MadeContact made = hard_contact(dice, is_face);
        const auto found = time_of(made.points, is_face);
        ASSERT_TRUE(found) << i;
        ASSERT_LE(*found, made.time) << i;
        ASSERT_GE(*found, 0.0) << i;
    }
}

void expect_none_made_up(std::uint64_t seed, int count) {
    Dice dice(seed);
    for (int i = 0; i < count; ++i) {
        const bool is_face = i % 2 == 0;
        ASSERT_FALSE(time_of(near_miss(dice, is_face), is_face)) << i;
    }
}

TEST(MovingPoints, NoContactMadeToMeasureIsMissedOrLate) {
    expect_neither_missed_nor_late(1, 40000);
}

TEST(MovingPoints, NoContactIsMadeUpWhereAPlaneKeepsApart) {
    expect_none_made_up(6, 40000);
}

TEST(SlowMovingPoints, TenMillionHardQueries) {
    expect_neither_missed_nor_late(7, 6000000);
    expect_none_made_up(8, 4000000);
}

/// Distance of the features at a time, by dense sampling: an upper bound of the true one.
double sampled_distance(const MovingPoints& points, bool is_face, double t) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = points.begin[i] + t * (points.end[i] - points.begin[i]);
    }
    constexpr int kSteps = 24;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i) {
        for (int k = 0; k <= (is_face ? kSteps - i : kSteps); ++k) {
            const double u = i / double{kSteps};
            const double v = k / double{kSteps};
            const Vec3 way = is_face ? x[0] - ((1 - u - v) * x[1] + u * x[2] + v * x[3])
                                     : ((1 - u) * x[0] + u * x[1]) - ((1 - v) * x[2] + v * x[3]);
            least = std::min(least, glm::length(way));
        }
    }
    return least;
}

TEST(MovingPoints, ThereIsAContactWhereOneIsSaidToBe) {
    Dice dice(2);
    int contacts = 0;
    for (int i = 0; i < 4000; ++i) {
        const bool is_face = i % 2 == 0;
        MovingPoints points;
        for (std::size_t k = 0; k < 4; ++k) {
            points.begin[k] = random_point(dice);
            points.end[k] = random_point(dice);
        }
        if (const auto time = time_of(points, is_face)) {
            ++contacts;
            // The grid is 1/24 of sides of up to 3.5.
            EXPECT_LT(sampled_distance(points, is_face, *time), 0.16) << i;
        }
    }
    EXPECT_GT(contacts, 300);
}

MovingPoints adversarial(Dice& dice) {
    MovingPoints points;
    const auto grid = [&] {
        return Vec3(dice.below(3) - 1.0, dice.below(3) - 1.0, dice.below(3) - 1.0);
    };
    const int kind = dice.below(6);
    for (std::size_t k = 0; k < 4; ++k) {
        points.begin[k] = grid();
        points.end[k] = grid();
        if (kind == 1) {  // in a plane at all times
            points.begin[k].y = points.end[k].y = 0.5;
        } else if (kind == 2) {  // on a line
            points.begin[k] = Vec3(dice.below(5), 0.0, 0.0);
            points.end[k] = Vec3(dice.below(5), 0.0, 0.0);
        } else if (kind == 3 && k > 0) {  // three points that do not move
            points.end[k] = points.begin[k];
        } else if (kind == 4) {  // sliding along a common direction
            points.end[k] = points.begin[k] + Vec3(dice.below(2), 0.0, 0.0);
        } else if (kind == 5) {  // a hair off the grid
            points.end[k].y = std::nextafter(points.end[k].y, dice.chance(0.5) ? 2.0 : -2.0);
        }
    }
    return points;
}

TEST(MovingPoints, FiltersAndIntegersAgreeOnHardQueries) {
    Dice dice(3);
    int contacts = 0;
    for (int i = 0; i < 60000; ++i) {
        const bool is_face = i % 2 == 0;
        const MovingPoints points = adversarial(dice);
        const auto fast = time_of(points, is_face);
        const auto exact = exact_time_of(points, is_face);
        ASSERT_EQ(fast.has_value(), exact.has_value()) << i;
        if (fast) {
            ++contacts;
            ASSERT_LE(*fast, *exact + 0x1p-50) << i;
            ASSERT_GE(*fast, *exact - 0x1p-39) << i;
        }
    }
    EXPECT_GT(contacts, 5000);
}

TEST(MovingPoints, AnswersDoNotDependOnTheOrderOfCornersAndEdges) {
    Dice dice(4);
    for (int i = 0; i < 20000; ++i) {
        const bool is_face = i % 2 == 0;
        const MovingPoints points = adversarial(dice);
        MovingPoints turned = points;
        for (auto* at : {&turned.begin, &turned.end}) {
            if (is_face) {
                std::rotate(at->begin() + 1, at->begin() + 2, at->end());
            } else {
                std::rotate(at->begin(), at->begin() + 2, at->end());
            }
        }
        ASSERT_EQ(time_of(points, is_face).has_value(), time_of(turned, is_face).has_value()) << i;
    }
}

TEST(MovingPoints, KnowsContactsAtTheEndsAndOnEdges) {
    MovingPoints drop{{Vec3(0.25, 1, 0.25), {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {}};
    drop.end = drop.begin;
    drop.end[0].y = 0.0;
    EXPECT_NEAR(*vertex_face_time(drop), 1.0, 0x1p-40);
    std::swap(drop.begin, drop.end);
    EXPECT_EQ(vertex_face_time(drop), 0.0);
    drop.begin[0].y = std::numeric_limits<double>::denorm_min();
    EXPECT_FALSE(vertex_face_time(drop));
    // On the far edge: u + v = 1.
    drop.begin[0] = {0.5, 1, 0.5};
    drop.end[0] = {0.5, -1, 0.5};
    EXPECT_NEAR(*vertex_face_time(drop), 0.5, 0x1p-40);
    drop.begin[0].x = drop.end[0].x = std::nextafter(0.5, 1.0);
    EXPECT_FALSE(vertex_face_time(drop));
    // A third, which is no double: the time is below it.
    drop.begin[0] = {0.25, 1, 0.25};
    drop.end[0] = {0.25, -2, 0.25};
    EXPECT_LE(*vertex_face_time(drop) * 3.0, 1.0);
    EXPECT_NEAR(*vertex_face_time(drop), 1.0 / 3.0, 0x1p-39);
}

TEST(RationalPoints, NeedNotBeDoubles) {
    RationalPoints points;
    points.begin = {{{{{"1", "3"}, {"1", "1"}, {"1", "3"}}},
                     {{{"0", "1"}, {"0", "1"}, {"0", "1"}}},
                     {{{"1", "1"}, {"0", "1"}, {"0", "1"}}},
                     {{{"0", "1"}, {"0", "1"}, {"1", "1"}}}}};
    points.end = points.begin;
    points.end[0][1] = {"-1", "7"};
    EXPECT_FALSE(as_doubles(points));
    EXPECT_NEAR(*vertex_face_time(points), 0.875, 0x1p-49);
    points.begin[0][0] = points.end[0][0] = {"6666666666666666666667", "10000000000000000000000"};
    EXPECT_FALSE(vertex_face_time(points));
    points.begin[0][0] = points.end[0][0] = {"-7", "16"};
    points.begin[0][2] = points.end[0][2] = {"3", "12"};
    points.end[0][1] = {"-5", "1"};
    const auto doubles = as_doubles(points);
    ASSERT_TRUE(doubles);
    EXPECT_EQ(doubles->begin[0], Vec3(-0.4375, 1.0, 0.25));
}

TEST(Separation, IsSeenBeforeContactAndNeverLate) {
    Dice dice(5);
    for (int i = 0; i < 300; ++i) {
        const bool is_face = i % 2 == 0;
        const MadeContact made = made_contact(dice, is_face);
        const SeparationOptions options{.least_separation = 1e-3, .tolerance = 1e-4};
        const auto found = is_face ? vertex_face_time_within(made.points, options)
                                   : edge_edge_time_within(made.points, options);
        ASSERT_TRUE(found) << i;
        EXPECT_LE(*found, made.time) << i;
    }
    // Falls from 1 to 0 along y: within 0.1 at 0.9.
    MovingPoints drop{{Vec3(0.25, 1, 0.25), {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {}};
    drop.end = drop.begin;
    drop.end[0].y = 0.0;
    const double time = *vertex_face_time_within(drop, {.least_separation = 0.1});
    EXPECT_LE(time, 0.9);
    EXPECT_GT(time, 0.899);
    drop.end[0].y = 0.11;
    EXPECT_FALSE(vertex_face_time_within(drop, {.least_separation = 0.1}));
}

}  // namespace
}  // namespace earshot::collision
