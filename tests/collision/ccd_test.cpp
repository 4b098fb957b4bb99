// SPDX-License-Identifier: MIT
// Against contacts that are made to measure in exact numbers, Sturm sequences, distances by
// sampling, and the filters against integers.
#include "earshot/collision/narrow_phase/ccd.h"

#include "earshot/collision/narrow_phase/internal/exact_ccd.h"
#include "earshot/collision/narrow_phase/min_separation.h"
#include "earshot/collision/narrow_phase/rational_ccd.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "ccd_oracle.h"
#include "generated_queries.h"
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
    return is_face ? vertex_face_ccd(points) : edge_edge_ccd(points);
}

std::optional<double> exact_time_of(const MovingPoints& points, bool is_face) {
    const IntegerPoints integers = integers_of(points);
    return is_face ? exact_vertex_face_ccd(integers) : exact_edge_edge_ccd(integers);
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
    double smallest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i) {
        for (int k = 0; k <= (is_face ? kSteps - i : kSteps); ++k) {
            const double u = i / double{kSteps};
            const double v = k / double{kSteps};
            const Vec3 way = is_face ? x[0] - ((1 - u - v) * x[1] + u * x[2] + v * x[3])
                                     : ((1 - u) * x[0] + u * x[1]) - ((1 - v) * x[2] + v * x[3]);
            smallest = std::min(smallest, glm::length(way));
        }
    }
    return smallest;
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

/// Hard queries at other scales: all coordinates huge or tiny, those of one end only, or far off.
MovingPoints scaled(MovingPoints points, Dice& dice) {
    constexpr std::array<int, 8> kExponents{-1074, -600, -200, -40, 40, 200, 330, 900};
    const auto scale = [&] {
        return std::ldexp(1.0, kExponents[static_cast<std::size_t>(dice.below(8))]);
    };
    const int kind = dice.below(60);
    const double begin = kind == 0 || kind == 1 ? scale() : 1.0;
    const double end = kind == 0 ? begin : kind == 2 ? scale() : 1.0;
    const double off = kind < 10 && kind > 2 ? 1e9 : 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        points.begin[i] = begin * points.begin[i] + off;
        points.end[i] = end * points.end[i] + off;
    }
    return points;
}

void expect_what_sturm_sequences_say(std::uint64_t seed, int count) {
    Dice dice(seed);
    int contacts = 0;
    for (int i = 0; i < count; ++i) {
        const bool is_face = dice.chance(0.5);
        const int kind = dice.below(8);
        const MovingPoints points = scaled(kind == 0   ? hard_contact(dice, is_face).points
                                           : kind == 1 ? near_miss(dice, is_face)
                                                       : adversarial(dice),
                                           dice);
        const auto found = time_of(points, is_face);
        const auto expected = test::first_touch(points, is_face);
        ASSERT_EQ(found.has_value(), expected.has_value()) << "seed " << seed << ", query " << i;
        if (found) {
            ++contacts;
            ASSERT_GE(*found, 0.0) << i;
            ASSERT_GE(*found, expected->from.value() - 0x1p-40)
                << "seed " << seed << ", query " << i;
            // No double lies between the true time and where it is known not to be after.
            ASSERT_LE(*found, expected->to.value() * (1.0 + 0x1p-52))
                << "seed " << seed << ", query " << i;
        }
    }
    EXPECT_GT(contacts, count / 8);
}

TEST(MovingPoints, AreWhatSturmSequencesSay) {
    expect_what_sturm_sequences_say(10, 1500);
}

TEST(SlowMovingPoints, ManyQueriesAreWhatSturmSequencesSay) {
    expect_what_sturm_sequences_say(11, 60000);
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
    EXPECT_NEAR(*vertex_face_ccd(drop), 1.0, 0x1p-40);
    std::swap(drop.begin, drop.end);
    EXPECT_EQ(vertex_face_ccd(drop), 0.0);
    drop.begin[0].y = std::numeric_limits<double>::denorm_min();
    EXPECT_FALSE(vertex_face_ccd(drop));
    // On the far edge: u + v = 1.
    drop.begin[0] = {0.5, 1, 0.5};
    drop.end[0] = {0.5, -1, 0.5};
    EXPECT_NEAR(*vertex_face_ccd(drop), 0.5, 0x1p-40);
    drop.begin[0].x = drop.end[0].x = std::nextafter(0.5, 1.0);
    EXPECT_FALSE(vertex_face_ccd(drop));
    // A third, which is no double: the time is below it.
    drop.begin[0] = {0.25, 1, 0.25};
    drop.end[0] = {0.25, -2, 0.25};
    EXPECT_LE(*vertex_face_ccd(drop) * 3.0, 1.0);
    EXPECT_NEAR(*vertex_face_ccd(drop), 1.0 / 3.0, 0x1p-39);
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
    EXPECT_NEAR(*vertex_face_ccd(points), 0.875, 0x1p-49);
    points.begin[0][0] = points.end[0][0] = {"6666666666666666666667", "10000000000000000000000"};
    EXPECT_FALSE(vertex_face_ccd(points));
    points.begin[0][0] = points.end[0][0] = {"-7", "16"};
    points.begin[0][2] = points.end[0][2] = {"3", "12"};
    points.end[0][1] = {"-5", "1"};
    const auto doubles = as_doubles(points);
    ASSERT_TRUE(doubles);
    EXPECT_EQ(doubles->begin[0], Vec3(-0.4375, 1.0, 0.25));
}

/// Along every axis, at the nearest places of the features at a time: found by ternary search,
/// since the distance is convex in each coordinate of the place.
double nearness(const MovingPoints& points, bool is_face, double t) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = (1.0 - t) * points.begin[i] + t * points.end[i];
    }
    const auto minimum = [](double end, const auto& value) {
        double low = 0.0, high = end;
        for (int i = 0; i < 50; ++i) {
            const double one = low + (high - low) / 3.0, two = high - (high - low) / 3.0;
            (value(one) <= value(two) ? high : low) = value(one) <= value(two) ? two : one;
        }
        return value(0.5 * (low + high));
    };
    return minimum(1.0, [&](double u) {
        return minimum(is_face ? 1.0 - u : 1.0, [&](double v) {
            const Vec3 way = is_face ? x[0] - ((1 - u - v) * x[1] + u * x[2] + v * x[3])
                                     : ((1 - u) * x[0] + u * x[1]) - ((1 - v) * x[2] + v * x[3]);
            return std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
        });
    });
}

/// Features that slide along each other at a height, or rest there, in a plane of any direction.
MovingPoints sliding(Dice& dice, bool is_face, double height) {
    const Vec3 corner = random_point(dice), along = random_point(dice);
    const Vec3 up = height * glm::normalize(glm::cross(along, random_point(dice)));
    const Vec3 side = glm::cross(up / height, along);
    MovingPoints points;
    points.begin =
        is_face
            ? std::array{corner + up + 0.2 * (along + side), corner, corner + along, corner + side}
            : std::array{corner + up, corner + up + along, corner, corner + along};
    points.end = points.begin;
    const Vec3 way = dice.between(-1.0, 1.0) * along;
    for (std::size_t i = 0; i < (is_face ? 1U : 2U); ++i) {
        points.end[i] += way;
    }
    return points;
}

TEST(Separation, IsHeldWhereFeaturesSlideAlongEachOther) {
    Dice dice(9);
    constexpr double kSeparation = 0.01;
    int contacts = 0, none = 0;
    for (int i = 0; i < 200; ++i) {
        const bool is_face = i % 2 == 0;
        const MovingPoints points =
            sliding(dice, is_face, kSeparation * (i % 3 == 0 ? 1.8 : dice.between(0.2, 1.7)));
        const MinSeparationOptions options{.min_separation = kSeparation, .tolerance = 1e-6};
        const auto found = is_face ? vertex_face_min_separation_ccd(points, options)
                                   : edge_edge_min_separation_ccd(points, options);
        ++(found ? contacts : none);
        const double until = found.value_or(1.0);
        for (int k = 0; until > 0.0 && k < 8; ++k) {
            const double t = until * k / 8.0;
            EXPECT_GT(nearness(points, is_face, t), kSeparation * (1.0 - 1e-12)) << i;
        }
        if (found) {
            EXPECT_LE(nearness(points, is_face, *found), kSeparation + 2e-6) << i;
        }
    }
    EXPECT_GT(contacts, 50);
    EXPECT_GT(none, 50);
}

TEST(Separation, IsSeenBeforeContactAndNeverLate) {
    Dice dice(5);
    for (int i = 0; i < 300; ++i) {
        const bool is_face = i % 2 == 0;
        const MadeContact made = made_contact(dice, is_face);
        const MinSeparationOptions options{.min_separation = 1e-3, .tolerance = 1e-4};
        const auto found = is_face ? vertex_face_min_separation_ccd(made.points, options)
                                   : edge_edge_min_separation_ccd(made.points, options);
        ASSERT_TRUE(found) << i;
        EXPECT_LE(*found, made.time) << i;
    }
    // Falls from 1 to 0 along y: within 0.1 at 0.9.
    MovingPoints drop{{Vec3(0.25, 1, 0.25), {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {}};
    drop.end = drop.begin;
    drop.end[0].y = 0.0;
    const double time = *vertex_face_min_separation_ccd(drop, {.min_separation = 0.1});
    EXPECT_LE(time, 0.9);
    EXPECT_GT(time, 0.899);
    drop.end[0].y = 0.11;
    EXPECT_FALSE(vertex_face_min_separation_ccd(drop, {.min_separation = 0.1}));
}

}  // namespace
}  // namespace earshot::collision
