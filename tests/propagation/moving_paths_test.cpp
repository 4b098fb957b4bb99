// SPDX-License-Identifier: MIT
#include "earshot/propagation/moving_paths.h"

#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kSpeedOfSound = 343.2;

Scene box_with(const Vec3& source, const Vec3& listener) {
    Scene scene = shoebox_room({40.0, 12.0, 30.0});
    scene.sources = {{.name = "s", .node = -1, .position = source}};
    scene.listeners = {{.name = "l", .node = -1, .position = listener}};
    return scene;
}

std::vector<Path> paths_of(const Scene& scene, const Options& options) {
    Simulator simulator(scene, options);
    return simulator.run()[0].paths;
}

/// Whether the path passes its edge, if it has one, at an end of the part that takes part.
bool is_at_end(const Path& path) {
    for (const auto& edge : path.edges) {
        for (const Vec3& end : edge) {
            for (const Vec3& point : path.points) {
                if (glm::distance(point, end) < 1e-6) {
                    return true;
                }
            }
        }
    }
    return false;
}

/// Those of a scene by their keys, without those that share one, as two parts of an edge do.
std::map<PathKey, Path> unique_paths(const Scene& scene,
                                     const Options& options,
                                     const FacetTable& facets) {
    std::map<PathKey, Path> paths;
    std::map<PathKey, int> count;
    for (const Path& path : paths_of(scene, options)) {
        ++count[path_key(path, facets)];
        paths.emplace(path_key(path, facets), path);
    }
    for (const auto& [key, times] : count) {
        if (times > 1 || is_at_end(paths.at(key))) {
            paths.erase(key);
        }
    }
    return paths;
}

/// Lengths of paths at one place, from the paths found at another.
void expect_predicted(Scene scene,
                      const Options& options,
                      const Vec3& source,
                      const Vec3& listener,
                      std::size_t min_paths) {
    const FacetTable facets{Simulator(scene, options)};
    for (const Path& path : paths_of(scene, options)) {
        const MovingLength found = length_of({.value = unfold(path, facets)},
                                             {.position = path.points.front()},
                                             {.position = path.points.back()});
        EXPECT_NEAR(found.length, path.length, 1e-9);
        EXPECT_NEAR(glm::distance(found.arrival, path.arrival), 0.0, 1e-7);
    }
    const auto before = unique_paths(scene, options, facets);
    scene.sources[0].position = source;
    scene.listeners[0].position = listener;
    std::size_t matched = 0;
    for (const auto& [key, path] : unique_paths(scene, options, facets)) {
        const auto same = before.find(key);
        if (same == before.end()) {
            continue;
        }
        ++matched;
        const MovingLength found = length_of(
            {.value = unfold(same->second, facets)}, {.position = source}, {.position = listener});
        EXPECT_NEAR(found.length, path.length, 1e-9);
        EXPECT_NEAR(glm::distance(found.arrival, path.arrival), 0.0, 1e-7);
    }
    EXPECT_GE(matched, min_paths);
}

TEST(UnfoldedPath, TellsTheLengthWhereverSourceAndListenerAre) {
    expect_predicted(box_with({5, 1, 3}, {30, 4, 20}),
                     {.specular_order = 3},
                     Vec3(17, 5, 6),
                     Vec3(28, 8, 25),
                     63);
}

// Around a corner of an L-shaped room, with reflections before and after the edge.
TEST(UnfoldedPath, TellsTheLengthOverAnEdge) {
    const std::vector<glm::dvec2> plan = {{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 10}, {0, 10}};
    Scene scene = extruded_room(plan, 3.0);
    scene.sources = {{.name = "s", .node = -1, .position = {8.0, 1.0, 2.0}}};
    scene.listeners = {{.name = "l", .node = -1, .position = {2.0, 1.5, 8.0}}};
    expect_predicted(scene,
                     {.specular_order = 2, .diffraction = 1},
                     Vec3(8.3, 1.2, 1.9),
                     Vec3(1.9, 1.4, 8.2),
                     10);
}

/// The images of a point in the box up to an order.
std::vector<Vec3> images_of(const Vec3& size, const Vec3& point, int order) {
    const auto along = [](double length, double x, int n) {
        return n * length + (n % 2 == 0 ? x : length - x);
    };
    std::vector<Vec3> images;
    for (int i = -order; i <= order; ++i) {
        for (int j = -order; j <= order; ++j) {
            for (int k = -order; k <= order; ++k) {
                if (std::abs(i) + std::abs(j) + std::abs(k) <= order) {
                    images.emplace_back(along(size.x, point.x, i),
                                        along(size.y, point.y, j),
                                        along(size.z, point.z, k));
                }
            }
        }
    }
    return images;
}

// Direct sound and all with one and two reflections in a box: the instant of emission solves
// t = t_e + r(t_e) / c, found here by bisection; the frequency is f dt_e / dt.
TEST(MovingPaths, AreHeardAtTheFrequencyAndDistanceOfTheirEmission) {
    const Vec3 size(40.0, 12.0, 30.0);
    const Vec3 listener(20.0, 2.6, 10.0);
    for (const double speed : {1.0, 10.0, 30.0}) {
        const auto place = [&](double t) {
            return Vec3(20.0 + speed * (t - 0.5), 2.0, 13.0);  // 3.1 m away at 0.5 s
        };
        const Trajectory way({{0.0, place(0.0)}, {1.0, place(1.0)}});
        const Options options{.specular_order = 2};
        MovingPaths moving;
        const Scene scene = box_with(place(0.0), listener);
        const FacetTable facets{Simulator(scene, options)};
        for (const double time : {0.0, 0.1, 0.2, 1.0}) {
            moving.add(time, paths_of(box_with(place(time), listener), options), facets);
        }
        for (double t = 0.4; t < 0.95; t += 0.05) {
            std::vector<double> emissions;
            const auto emission_of = [&](std::size_t image, double at) {
                double low = at - 0.5, high = at;
                while (high - low > 1e-14 * (1.0 + high)) {
                    const double middle = 0.5 * (low + high);
                    if (middle == low || middle == high) {
                        break;
                    }
                    const double distance =
                        glm::distance(images_of(size, place(middle), 2)[image], listener);
                    (middle + distance / kSpeedOfSound < at ? low : high) = middle;
                }
                return 0.5 * (low + high);
            };
            std::multimap<double, double> expected;  // emission, d emission / dt
            for (std::size_t image = 0; image < 25; ++image) {
                constexpr double kStep = 1e-5;
                const double rate =
                    (emission_of(image, t + kStep) - emission_of(image, t - kStep)) / (2.0 * kStep);
                expected.emplace(emission_of(image, t), rate);
            }
            // Walls at right angles may be met in either order: that is one path all the same.
            ASSERT_EQ(moving.paths().size(), 25U);
            std::map<double, std::array<double, 2>> found;  // share, rate
            for (const MovingPath& path : moving.paths()) {
                EXPECT_TRUE(path.is_fixed);
                const PathReception reception =
                    moving.receive(path, way, {.position = listener}, t, kSpeedOfSound, t - 0.1);
                EXPECT_NEAR(reception.emission + reception.delay, t, 1e-12);
                const PathShare share = moving.share_at(path, reception.emission);
                const double heard = share.of_lower + share.of_upper;
                const auto same = found.lower_bound(reception.emission - 1e-10);
                if (same != found.end() && same->first < reception.emission + 1e-10) {
                    same->second[0] += heard;
                } else if (heard > 0.0) {
                    found.insert({reception.emission, {heard, 1.0 - reception.delay_rate}});
                }
            }
            ASSERT_EQ(found.size(), 25U) << speed << " m/s at " << t;
            auto of_expected = expected.begin();
            for (const auto& [emission, share_and_rate] : found) {
                EXPECT_NEAR(emission, of_expected->first, 1e-12);
                EXPECT_NEAR(share_and_rate[0], 1.0, 1e-12);
                EXPECT_NEAR(share_and_rate[1], of_expected->second, 1e-8);
                ++of_expected;
            }
        }
    }
}

TEST(MovingPaths, HearAMovingListenerWhereItIs) {
    // Approaching a source that stays: emission = t - r(t) / c.
    const Trajectory source(Vec3(5, 1, 3));
    MovingPaths moving;
    const Options options{.specular_order = 1};
    const Scene scene = box_with({5, 1, 3}, {30, 4, 20});
    const FacetTable facets{Simulator(scene, options)};
    for (const double time : {0.0, 1.0}) {
        moving.add(time, paths_of(scene, options), facets);
    }
    const Vec3 velocity(-20.0, 1.0, -15.0);
    const auto direct = moving.paths().front();
    for (const double t : {0.2, 0.5, 0.8}) {
        const Motion listener{.position = Vec3(30, 4, 20) + t * velocity, .velocity = velocity};
        const PathReception reception =
            moving.receive(direct, source, listener, t, kSpeedOfSound, 0.0);
        EXPECT_NEAR(
            reception.delay, glm::distance(listener.position, Vec3(5, 1, 3)) / 343.2, 1e-13);
        const Vec3 towards = glm::normalize(Vec3(5, 1, 3) - listener.position);
        EXPECT_NEAR(-reception.delay_rate, glm::dot(velocity, towards) / 343.2, 1e-12);
    }
}

/// A path straight from source to listener.
Path direct_path(double pressure) {
    Path path;
    path.points = {Vec3(0.0), Vec3(2.0, 0.0, 0.0)};
    path.length = 2.0;
    path.pressure.fill(pressure);
    return path;
}

TEST(MovingPaths, FadeInAndOutBetweenInstants) {
    const Scene scene = box_with({5, 1, 3}, {30, 4, 20});
    const FacetTable facets{Simulator(scene)};
    MovingPaths moving;
    const std::vector<Path> one = {direct_path(1.0)}, half = {direct_path(0.5)};
    moving.add(0.0, {}, facets);
    moving.add(0.1, one, facets);
    moving.add(0.2, half, facets);
    moving.add(0.3, {}, facets);
    moving.add(0.4, one, facets);
    ASSERT_EQ(moving.paths().size(), 2U);
    const MovingPath& path = moving.paths()[0];
    EXPECT_EQ(path.instants[1].pressure_at_1_m[0][3], 1.0);
    EXPECT_EQ(moving.begin_of(path), 0.0);
    EXPECT_EQ(moving.end_of(path), 0.3);
    const auto level = [&](const MovingPath& of, double time) {
        const PathShare share = moving.share_at(of, time);
        return share.of_lower + share.of_upper;
    };
    EXPECT_EQ(level(path, -1.0), 0.0);
    EXPECT_NEAR(level(path, 0.025), 0.5 - 0.5 * std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(level(path, 0.05), 0.5, 1e-12);
    EXPECT_NEAR(level(path, 0.15), 1.0, 1e-12);
    EXPECT_NEAR(moving.share_at(path, 0.125).of_upper, 0.25, 1e-12);
    EXPECT_NEAR(level(path, 0.25), 0.5, 1e-12);
    EXPECT_EQ(level(path, 0.35), 0.0);
    EXPECT_NEAR(level(moving.paths()[1], 0.35), 0.5, 1e-12);
    EXPECT_EQ(level(moving.paths()[1], 9.0), 1.0);
}

// A wall that comes nearer at constant speed mirrors the source twice as fast.
TEST(MovingPaths, FollowAMovingWall) {
    MovingPaths moving;
    const Trajectory source(Vec3(5, 1, 3));
    const Vec3 listener(9, 4, 20);
    for (const double time : {0.0, 0.1, 0.2, 0.3}) {
        Scene scene = shoebox_room({40.0 - 2.0 * time, 12.0, 30.0});
        scene.sources = {{.name = "s", .node = -1, .position = {5, 1, 3}}};
        scene.listeners = {{.name = "l", .node = -1, .position = listener}};
        const Options options{.specular_order = 1};
        moving.add(time, paths_of(scene, options), FacetTable{Simulator(scene, options)});
    }
    ASSERT_EQ(moving.paths().size(), 7U);
    std::size_t moved = 0;
    for (const MovingPath& path : moving.paths()) {
        if (path.is_fixed) {
            continue;
        }
        ++moved;
        const PathReception reception =
            moving.receive(path, source, {.position = listener}, 0.27, kSpeedOfSound, 0.1);
        const Vec3 image(80.0 - 4.0 * reception.emission - 5.0, 1, 3);
        const double distance = glm::distance(image, listener);
        EXPECT_NEAR(reception.delay, distance / kSpeedOfSound, 1e-12);
        const double towards = 4.0 * (image.x - listener.x) / distance / kSpeedOfSound;
        EXPECT_NEAR(1.0 - reception.delay_rate, 1.0 / (1.0 - towards), 1e-9);
    }
    EXPECT_EQ(moved, 1U);
}

}  // namespace
}  // namespace earshot::propagation
