// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/direction_triangulation.h"

#include "earshot/audio/internal/vector3.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

namespace earshot::audio {
namespace {

Direction at(double azimuth_degrees, double elevation_degrees) {
    const double azimuth = azimuth_degrees * std::numbers::pi / 180.0;
    const double elevation = elevation_degrees * std::numbers::pi / 180.0;
    return {std::cos(elevation) * std::cos(azimuth),
            std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

Direction random_direction(std::uint64_t seed, std::uint64_t i) {
    const double z = random_between(seed, 0, i, -1.0, 1.0);
    const double azimuth = random_between(seed, 1, i, 0.0, 360.0);
    return at(azimuth, std::asin(z) * 180.0 / std::numbers::pi);
}

std::vector<Direction> random_directions(std::uint64_t seed, std::size_t count) {
    std::vector<Direction> result;
    for (std::uint64_t i = 0; i < count; ++i) {
        result.push_back(random_direction(seed, i));
    }
    return result;
}

// Equal steps of azimuth at equal steps of elevation: four directions on a circle everywhere, and
// the poles once for each azimuth.
std::vector<Direction> grid(double lowest, double step) {
    std::vector<Direction> result;
    for (double elevation = lowest; elevation <= 90.0; elevation += step) {
        for (double azimuth = 0.0; azimuth < 360.0; azimuth += step) {
            result.push_back(at(azimuth, elevation));
        }
    }
    return result;
}

// The weighted mean of the directions, scaled to unit length.
Direction mean_of(const std::vector<Direction>& directions, const DirectionWeights& weights) {
    Direction sum{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sum[axis] += weights.weight[k] * directions[weights.index[k]][axis];
        }
    }
    return scaled(sum, 1.0 / length(sum));
}

double sum_of(const DirectionWeights& weights) {
    return weights.weight[0] + weights.weight[1] + weights.weight[2];
}

TEST(DirectionTriangulation, EnclosesADirectionByThree) {
    for (const auto& directions : {random_directions(1, 200), grid(-90.0, 10.0)}) {
        const DirectionTriangulation triangulation(directions);
        for (std::uint64_t i = 0; i < 500; ++i) {
            const Direction direction = random_direction(2, i);
            const DirectionWeights weights = triangulation.weights(direction);
            EXPECT_NEAR(sum_of(weights), 1.0, 1e-12);
            EXPECT_GE(*std::min_element(weights.weight.begin(), weights.weight.end()), 0.0);
            EXPECT_LT(length(difference(mean_of(directions, weights), direction)), 1e-9) << i;
        }
    }
}

// What makes a triangulation Delaunay's: no direction lies in the circle through a triangle.
TEST(DirectionTriangulation, HasEmptyCircles) {
    const auto directions = random_directions(3, 300);
    const DirectionTriangulation triangulation(directions);
    for (std::uint64_t i = 0; i < 300; ++i) {
        const auto [a, b, c] = triangulation.weights(random_direction(4, i)).index;
        Direction axis = cross(difference(directions[b], directions[a]),
                               difference(directions[c], directions[a]));
        axis = scaled(axis, (dot(axis, directions[a]) < 0.0 ? -1.0 : 1.0) / length(axis));
        for (const Direction& other : directions) {
            EXPECT_LT(dot(other, axis), dot(directions[a], axis) + 1e-7) << i;
        }
    }
}

TEST(DirectionTriangulation, OfAGridHasTheCornersOfItsCells) {
    const auto directions = grid(-90.0, 10.0);
    const DirectionTriangulation triangulation(directions);
    for (std::uint64_t i = 0; i < 200; ++i) {
        const double azimuth = random_between(5, 0, i, 0.0, 359.0);
        const double elevation = random_between(5, 1, i, -69.0, 69.0);
        for (const std::size_t corner : triangulation.weights(at(azimuth, elevation)).index) {
            const auto& [x, y, z] = directions[corner];
            const double from_elevation = std::asin(z) * 180.0 / std::numbers::pi - elevation;
            const double from_azimuth =
                std::remainder(std::atan2(y, x) * 180.0 / std::numbers::pi - azimuth, 360.0);
            // A meridian's arc bulges over the straight side of a cell near the poles.
            EXPECT_LT(std::abs(from_elevation), 10.5);
            EXPECT_LT(std::abs(from_azimuth), 10.0 + 1e-9);
        }
    }
}

TEST(DirectionTriangulation, GivesAMeasuredDirectionAlone) {
    for (const auto& directions :
         {random_directions(6, 50), grid(-40.0, 10.0), grid(0.0, 15.0), random_directions(6, 2)}) {
        const DirectionTriangulation triangulation(directions);
        for (const Direction& direction : directions) {
            const DirectionWeights weights = triangulation.weights(direction);
            EXPECT_EQ(weights.weight[0], 1.0);
            EXPECT_EQ(weights.weight[1], 0.0);
            EXPECT_EQ(weights.weight[2], 0.0);
            EXPECT_LT(length(difference(directions[weights.index[0]], direction)), 1e-12);
        }
    }
}

TEST(DirectionTriangulation, OfOnePlaneInterpolatesAlongTheRing) {
    std::vector<Direction> ring;
    for (int k = 0; k < 36; ++k) {
        ring.push_back(at(10.0 * k, 0.0));
    }
    const DirectionTriangulation triangulation(ring);
    for (const double elevation : {0.0, 40.0, -70.0}) {
        const DirectionWeights weights = triangulation.weights(at(124.0, elevation));
        EXPECT_LT(length(difference(mean_of(ring, weights), at(124.0, 0.0))), 1e-12);
        EXPECT_EQ((std::set<std::size_t>(weights.index.begin(), weights.index.end())),
                  (std::set<std::size_t>{12, 13}));
    }
    EXPECT_EQ(triangulation.weights(at(0.0, 90.0)).weight[0], 1.0);
}

TEST(DirectionTriangulation, DoesNotReachAcrossTheGapOfAnArc) {
    std::vector<Direction> arc;
    for (int k = -9; k <= 9; ++k) {
        arc.push_back(at(10.0 * k, 0.0));
    }
    const DirectionWeights weights = DirectionTriangulation(arc).weights(at(170.0, 0.0));
    EXPECT_EQ(weights.weight[0], 1.0);
    EXPECT_EQ(weights.index[0], 18U);
}

TEST(DirectionTriangulation, OfAPartOfTheSphereTakesTheClosestOfItsBorder) {
    const auto upper = grid(-40.0, 10.0);
    const DirectionTriangulation triangulation(upper);
    // The border is made of great arcs, which bulge towards the pole.
    const DirectionWeights weights = triangulation.weights(at(33.0, -75.0));
    const Direction mean = mean_of(upper, weights);
    EXPECT_NEAR(std::atan2(mean[1], mean[0]) * 180.0 / std::numbers::pi, 33.0, 2.0);
    EXPECT_NEAR(std::asin(mean[2]) * 180.0 / std::numbers::pi, -40.0, 0.5);
}

TEST(DirectionTriangulation, OfFewDirectionsIsBetweenThem) {
    const std::vector<Direction> one{at(20.0, 10.0)};
    EXPECT_EQ(DirectionTriangulation(one).weights(at(-100.0, 0.0)).weight[0], 1.0);
    const std::vector<Direction> two{at(0.0, 0.0), at(90.0, 0.0)};
    const DirectionWeights half = DirectionTriangulation(two).weights(at(45.0, 30.0));
    EXPECT_NEAR(half.weight[0], 0.5, 1e-12);
    EXPECT_NEAR(half.weight[1], 0.5, 1e-12);
    const std::vector<Direction> opposite{at(90.0, 0.0), at(-90.0, 0.0)};
    EXPECT_EQ(DirectionTriangulation(opposite).weights(at(80.0, 30.0)).index[0], 0U);
    EXPECT_EQ(DirectionTriangulation(opposite).weights(at(-20.0, 0.0)).index[0], 1U);
    const std::vector<Direction> octahedron{
        {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const double third = 1.0 / std::sqrt(3.0);
    const DirectionWeights middle =
        DirectionTriangulation(octahedron).weights({third, -third, third});
    for (const double weight : middle.weight) {
        EXPECT_NEAR(weight, 1.0 / 3.0, 1e-12);
    }
}

// A ring of a grid stands for a zone of the sphere, whose area is known (Archimedes).
TEST(DirectionTriangulation, SharesTheSphereAmongItsDirections) {
    const auto directions = grid(-90.0, 5.0);
    const std::vector<double> shares = DirectionTriangulation(directions).sphere_shares();
    EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-12);
    for (const double elevation : {-60.0, 0.0, 30.0}) {
        double ring = 0.0;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (std::abs(directions[i][2] - std::sin(elevation * std::numbers::pi / 180.0)) <
                1e-9) {
                ring += shares[i];
            }
        }
        const auto sine = [](double degrees) {
            return std::sin(degrees * std::numbers::pi / 180.0);
        };
        const double zone = (sine(elevation + 2.5) - sine(elevation - 2.5)) / 2.0;
        EXPECT_NEAR(ring / zone, 1.0, 0.01) << elevation;
    }
}

}  // namespace
}  // namespace earshot::audio
