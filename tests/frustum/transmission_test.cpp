// SPDX-License-Identifier: MIT
#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/path_finder.h"

#include <gtest/gtest.h>

#include "frustum/quad_room.h"
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

constexpr double kSheet = 2.3;  // x of the sheet
const Vec3 kSize = {5.0, 3.0, 4.0};

/// A box with a sheet across it that is transmissive; the sheet is the last facet.
struct DividedBox {
    QuadRoom room;
    std::vector<std::uint8_t> transmissive;

    explicit DividedBox(double lean = 0.0) {
        room.add_box(Vec3(0.0), {kSize.x, 0, 0}, {0, kSize.y, 0}, {0, 0, kSize.z}, true);
        room.add_quad({kSheet, 0, 0},
                      {kSheet + lean, kSize.y, 0},
                      {kSheet + lean, kSize.y, kSize.z},
                      {kSheet, 0, kSize.z});
        room.finish();
        transmissive.assign(7, 0);
        transmissive.back() = 1;
    }

    SceneView scene_view() const {
        SceneView result = room.scene_view();
        result.transmissive = transmissive;
        return result;
    }
};

/// Where an image of a coordinate lies, and over how many walls.
struct Image {
    double position;
    int walls;
};

std::vector<Image> images_of(double x, double size, int max_period) {
    std::vector<Image> images;
    for (int period = -max_period; period <= max_period; ++period) {
        images.push_back({2.0 * period * size + x, std::abs(2 * period)});
        images.push_back({2.0 * period * size - x, std::abs(2 * period - 1)});
    }
    return images;
}

/// How often a straight line from x to y, unfolded over the walls, passes the sheet.
int transmissions_between(double x, double y) {
    int transmissions = 0;
    for (int period = -20; period <= 20; ++period) {
        for (const double sheet : {kSheet, -kSheet}) {
            const double position = 2.0 * period * kSize.x + sheet;
            transmissions += (position - x) * (position - y) < 0.0 ? 1 : 0;
        }
    }
    return transmissions;
}

TEST(Transmission, PathsOverTheWallsOfADividedBoxAreThoseOfTheBox) {
    const DividedBox box;
    const Vec3 source = {0.7, 1.1, 1.3};
    const std::vector<Vec3> listeners = {{1.9, 2.0, 3.1}, {4.2, 0.9, 2.2}};
    constexpr int kOrder = 4;
    std::size_t counted = 0;
    const auto found =
        find_specular_paths(box.scene_view(), source, listeners, {.max_order = kOrder});
    for (std::size_t listener = 0; listener < listeners.size(); ++listener) {
        std::vector<std::pair<double, int>> expected, actual;  // length, transmissions
        const Vec3& to = listeners[listener];
        for (const Image& x : images_of(to.x, kSize.x, kOrder)) {
            for (const Image& y : images_of(to.y, kSize.y, kOrder)) {
                for (const Image& z : images_of(to.z, kSize.z, kOrder)) {
                    const int transmissions = transmissions_between(source.x, x.position);
                    if (x.walls + y.walls + z.walls + transmissions <= kOrder) {
                        expected.emplace_back(
                            glm::distance(source, Vec3(x.position, y.position, z.position)),
                            transmissions);
                    }
                }
            }
        }
        for (const SpecularPath& path : found.paths) {
            const int transmissions = static_cast<int>(
                std::count(path.transmitted.begin(), path.transmitted.end(), std::uint8_t{1}));
            const auto on_sheet = std::count_if(path.triangles.begin(),
                                                path.triangles.end(),
                                                [](auto triangle) { return triangle >= 12; });
            if (path.listener == listener && on_sheet == transmissions) {
                actual.emplace_back(path.length, transmissions);
            }
        }
        std::sort(expected.begin(), expected.end());
        std::sort(actual.begin(), actual.end());
        ASSERT_EQ(actual.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_NEAR(actual[i].first, expected[i].first, 1e-12);
            EXPECT_EQ(actual[i].second, expected[i].second);
        }
        counted += expected.size();
    }
    EXPECT_GT(counted, 60U);
}

TEST(Transmission, PointsAndTrianglesStandInTheOrderOfTheWay) {
    const DividedBox box(0.4);
    const auto found = find_specular_paths(
        box.scene_view(), {0.7, 1.1, 1.3}, std::vector<Vec3>{{4.2, 0.9, 2.2}}, {.max_order = 4});
    std::size_t through = 0;
    for (const SpecularPath& path : found.paths) {
        ASSERT_EQ(path.points.size(), path.triangles.size() + 2);
        ASSERT_TRUE(path.transmitted.empty() || path.transmitted.size() == path.triangles.size());
        double length = 0.0;
        for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
            length += glm::distance(path.points[i], path.points[i + 1]);
        }
        EXPECT_NEAR(length, path.length, 1e-12);
        for (std::size_t i = 0; i < path.transmitted.size(); ++i) {
            if (path.transmitted[i] == 0) {
                continue;
            }
            ++through;
            EXPECT_GE(path.triangles[i], 12U);
            const Vec3 in = glm::normalize(path.points[i + 1] - path.points[i]);
            const Vec3 out = glm::normalize(path.points[i + 2] - path.points[i + 1]);
            EXPECT_NEAR(glm::distance(in, out), 0.0, 1e-9);
        }
    }
    EXPECT_GT(through, 10U);
}

TEST(Transmission, NothingIsMissedInRandomRoomsWithSheets) {
    std::size_t through = 0;
    for (std::uint64_t seed = 0; seed < 25; ++seed) {
        const RandomRoom random(seed, 3);
        SceneView scene_view = random.room.scene_view();
        std::vector<std::uint8_t> transmissive(scene_view.facets.facets.size(), 0);
        for (std::size_t i = 6; i < transmissive.size(); ++i) {
            transmissive[i] = random_bits(seed, 50, i) % 4 > 0 ? 1 : 0;
        }
        scene_view.transmissive = transmissive;
        constexpr int kOrder = 3;
        const auto expected =
            find_specular_paths_brute_force(scene_view, random.source, random.listeners, kOrder);
        for (const bool forward_only : {false, true}) {
            const PathFinder finder(scene_view,
                                    {.trace = {.max_order = kOrder}, .forward_only = forward_only});
            const auto found = finder.find(random.source, finder.trace_listeners(random.listeners));
            EXPECT_EQ(found.paths, expected.paths) << seed;
        }
        for (const SpecularPath& path : expected.paths) {
            through += path.transmitted.empty() ? 0 : 1;
        }
    }
    EXPECT_GT(through, 20U);
}

TEST(Transmission, AnEdgeOfTwoSheetsIsPassedOnceAndALegAlongASheetIsBlocked) {
    QuadRoom room;
    room.add_quad({0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0});
    room.add_quad({2, 0, 0}, {4, 0, 1}, {4, 2, 1}, {2, 2, 0});
    room.finish();
    SceneView scene_view = room.scene_view();
    const std::vector<std::uint8_t> both = {1, 1};
    scene_view.transmissive = both;
    const auto direct = [&](const Vec3& from, const Vec3& to) {
        return find_specular_paths(scene_view, from, std::vector<Vec3>{to}, {.max_order = 2});
    };
    const auto through_edge = direct({2, 1, -1}, {2, 1, 1});
    ASSERT_EQ(through_edge.paths.size(), 1U);
    EXPECT_EQ(through_edge.paths[0].transmitted, std::vector<std::uint8_t>{1});
    EXPECT_TRUE(direct({-1, 1, 0}, {1, 1, 0}).paths.empty());
}

TEST(Limits, LeaveOutExactlyWhatFallsUnderThem) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const RandomRoom random(seed, 3);
        SceneView scene_view = random.room.scene_view();
        std::vector<double> factors;
        for (std::size_t i = 0; i < scene_view.facets.facets.size(); ++i) {
            factors.push_back(earshot::random(seed, 60, i));
        }
        scene_view.max_pressure_factor = factors;
        const auto all =
            find_specular_paths(scene_view, random.source, random.listeners, {.max_order = 3});
        if (all.paths.empty()) {
            continue;
        }
        const auto pressure_of = [&](const SpecularPath& path) {
            double pressure = 1.0;
            for (const auto triangle : path.triangles) {
                pressure *= factors[scene_view.facets.of_triangle[triangle]];
            }
            return pressure / path.length;
        };
        const SpecularPath& some = all.paths[all.paths.size() / 2];
        const double least = 1.0000001 * pressure_of(some);
        std::vector<SpecularPath> short_ones, loud_ones;
        for (const SpecularPath& path : all.paths) {
            if (path.length <= some.length) {
                short_ones.push_back(path);
            }
            if (pressure_of(path) >= least) {
                loud_ones.push_back(path);
            }
        }
        const auto found = [&](const TraceOptions& options) {
            return find_specular_paths(scene_view, random.source, random.listeners, options).paths;
        };
        EXPECT_EQ(found({.max_order = 3, .max_length = some.length}), short_ones) << seed;
        EXPECT_EQ(found({.max_order = 3, .min_pressure = least}), loud_ones) << seed;
    }
}

}  // namespace
}  // namespace earshot::frustum
